#include "exporters/formats.hpp"

#include <array>

namespace packmpi::exporters {
namespace {

constexpr std::array table{
    Format{{"lammps", ".lammps.data", ".in", "LAMMPS: data file (atom_style sphere) and an in-file that runs it"},
           lammps::make,
           SpringsBy::motion_of_radii},
    Format{
        {"liggghts", ".liggghts.data", ".in", "LIGGGHTS: data file (atom_style granular) and an in-file that runs it"},
        liggghts::make,
        SpringsBy::motion_of_middles},
    Format{{"yade", ".yade.txt", ".py", "YADE: text for SpherePack.load and a script that runs it"},
           yade::make,
           SpringsBy::forces},
    Format{{"esys", ".esys.geo", ".txt", "ESyS-Particle, GenGeo: LSMGeometry 1.2 and a note on the material"},
           esys::make},
    Format{{"mercurydpm", ".mercury.data", ".cpp", "MercuryDPM: text for readDataFile and a driver that reads it"},
           mercurydpm::make},
    Format{
        {"lethe", ".lethe.txt", ".prm", "Lethe: table for insertion method = file and the parameters that go with it"},
        lethe::make},
    Format{{"pfc", ".pfc.dat", ".py", "PFC: commands, and a script for PFC's Python that reads them faster"},
           pfc::make},
    Format{{"xyz", ".xyz", "", "OVITO, ASE: extended XYZ"}, xyz::make},
    Format{{"csv", ".csv", "", "tables and scripts: comma separated values, a row a particle"}, csv::make},
    Format{{"vtk", ".vtp", "", "VTK, ParaView: PolyData (XML, binary), a vertex a particle"}, vtk::make}};

}  // namespace

std::span<const Format> formats() { return table; }

}  // namespace packmpi::exporters
