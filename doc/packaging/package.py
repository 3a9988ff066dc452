# Recipe for Spack: put it into a repository of your own as packages/packmpi/package.py, give it the address of your
# clone in `git`, then: spack install packmpi
from spack.package import *


class Packmpi(CMakePackage):
    """Dense random packs of spheres to start discrete element studies from, on any number of MPI ranks."""

    homepage = "https://doi.org/10.1590/1679-78251694"
    git = "file:///path/to/packmpi"

    license("BSD-3-Clause")

    version("main", branch="main")

    variant("petsc64", default=False, description="PETSc with 64-bit indices")

    depends_on("c", type="build")
    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("ninja", type="build")
    depends_on("pkgconfig", type="build")
    depends_on("mpi")
    depends_on("petsc@3.18: +mpi ~complex ~int64", when="~petsc64")
    depends_on("petsc@3.18: +mpi ~complex +int64", when="+petsc64")
    depends_on("hdf5@1.10.2: +mpi")
    depends_on("metis@5:")
    depends_on("boost@1.74: +math")
    depends_on("voropp@0.4.6:")
    depends_on("eigen@3.4:")
    depends_on("tomlplusplus@3.3:")
    depends_on("cli11@2.1:")
    depends_on("fmt@9:")
    depends_on("spdlog@1.10: +fmt_external")
    depends_on("random123@1.14:")
    depends_on("nlohmann-json@3.11:")
    depends_on("googletest@1.12: +gmock", type="test")

    conflicts("%gcc@:11", msg="C++20 as packmpi uses it needs GCC 12 or newer")

    generator("ninja")

    def cmake_args(self):
        return [
            self.define("PACKMPI_TESTS", self.run_tests),
            self.define("PACKMPI_BENCHMARKS", False),
            self.define("PACKMPI_WERROR", False),
            self.define("PACKMPI_PETSC64", self.spec.satisfies("+petsc64")),
        ]
