/// Coefficient of restitution and damping ratio: two ways to say one thing (doc/theory.md, "Damping").
#pragma once

namespace packmpi::input {

/// Restitution e of a head-on impact of this damping ratio xi >= 0, at any speed. The contact law is linear in
/// s = delta^(5/4): s'' + 2 zeta w s' + w^2 s = 0 with zeta = sqrt(6/5) xi (Antypov and Elliott 2011). With the tension
/// cut-off the contact ends where the force is zero, ln e = -2 g cot g, cos g = zeta (hyperbolic beyond 1); without,
/// where the particles part, ln e = -pi zeta / sqrt(1 - zeta^2), and from zeta = 1 on they stay together: 0. Local,
/// pure.
[[nodiscard]] double restitution_of(double damping_ratio, bool tension_cutoff);

/// The damping ratio that gives this restitution, 0 < e <= 1; within 1e-14 of it. The same bits on any machine.
[[nodiscard]] double damping_of(double restitution, bool tension_cutoff);

}  // namespace packmpi::input
