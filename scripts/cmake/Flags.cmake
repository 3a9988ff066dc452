# The rules every translation unit of ours is compiled by.
# Same bits on every machine: no contraction of a*b+c, no fast math. Contraction would differ between CPUs.
# No semantic interposition: inside the shared library, calls may be inlined as in a static one.
add_library(packmpi_flags INTERFACE)
target_compile_options(packmpi_flags INTERFACE
  -ffp-contract=off -fno-math-errno -fno-trapping-math -fno-semantic-interposition
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion
  $<$<BOOL:${PACKMPI_WERROR}>:-Werror>)
# Without the checks of pointers that AddressSanitizer finds too: a fifth to a third of the time of compilation.
if(PACKMPI_SANITIZE)
  target_compile_options(packmpi_flags INTERFACE
    -fsanitize=address,undefined -fno-sanitize=null,object-size,vptr -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  target_link_options(packmpi_flags INTERFACE -fsanitize=address,undefined)
endif()
