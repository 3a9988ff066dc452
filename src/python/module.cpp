// packmpi._core: include/packmpi/ in Python, as thin as it can be. What users see is in scripts/python/packmpi.
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <utility>

#include "packmpi/packmpi.hpp"

namespace py = pybind11;

namespace packmpi {
namespace {

// For the life of the process; ended by the package's atexit, before mpi4py ends MPI.
std::unique_ptr<Library>& library() {
  static std::unique_ptr<Library> running;
  return running;
}

void start() {
  if (!library()) library() = std::make_unique<Library>();
}

void end() { library().reset(); }

/// None: all ranks. A communicator of mpi4py comes as the number that its py2f() gives.
MPI_Comm communicator(const std::optional<std::int64_t>& number) {
  start();
  return number ? communicator_of(*number) : all_ranks();
}

/// An array that is this memory; `owner` lives as long as it does. Read-only: the pack is what was made.
template <class Number>
py::array_t<Number> view(const py::object& owner, std::span<const Number> values, py::ssize_t columns) {
  const auto rows = static_cast<py::ssize_t>(values.size()) / columns;
  std::vector<py::ssize_t> shape{rows};
  if (columns > 1) shape.push_back(columns);
  py::array_t<Number> array(shape, values.data(), owner);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

py::dict contact_views(const py::object& owner, const ContactSpans& contacts, bool of_walls) {
  py::dict all;
  if (of_walls) {
    all["particle"] = view(owner, contacts.pair, 1);
    all["wall"] = view(owner, contacts.wall, 1);
  } else {
    all["pair"] = view(owner, contacts.pair, 2);
  }
  all["overlap"] = view(owner, contacts.overlap, 1);
  all["normal"] = view(owner, contacts.normal, 3);
  all["force"] = view(owner, contacts.force, 3);
  if (!contacts.displacement.empty()) all["tangential_displacement"] = view(owner, contacts.displacement, 3);
  return all;
}

void define_packing(py::module_& module) {
  const auto of = [](const py::object& self) -> const Packing& { return self.cast<const Packing&>(); };
  py::class_<Packing>(module, "Packing")
      .def_property_readonly("id", [of](const py::object& self) { return view(self, of(self).id(), 1); })
      .def_property_readonly("position", [of](const py::object& self) { return view(self, of(self).position(), 3); })
      .def_property_readonly("radius", [of](const py::object& self) { return view(self, of(self).radius(), 1); })
      .def_property_readonly("velocity", [of](const py::object& self) { return view(self, of(self).velocity(), 3); })
      .def_property_readonly("spin",
                             [of](const py::object& self) -> py::object {
                               const auto& pack = of(self);
                               if (pack.spin().empty() && pack.count() > 0) return py::none();
                               return view(self, pack.spin(), 3);
                             })
      .def_property_readonly("layer", [of](const py::object& self) { return view(self, of(self).layer(), 1); })
      .def_property_readonly("contacts", [of](const py::object& self) { return view(self, of(self).contacts(), 1); })
      .def_property_readonly("component", [of](const py::object& self) { return view(self, of(self).component(), 1); })
      .def_property_readonly(
          "pair_contacts",
          [of](const py::object& self) { return contact_views(self, of(self).pair_contacts(), false); })
      .def_property_readonly(
          "wall_contacts", [of](const py::object& self) { return contact_views(self, of(self).wall_contacts(), true); })
      // Where the memory is, as numpy tells it of its arrays (ctypes.data): for the test that nothing is copied.
      .def_property_readonly(
          "address", [](const Packing& self) { return reinterpret_cast<std::uintptr_t>(self.position().data()); })
      .def_property_readonly("summary", &Packing::summary)
      .def_property_readonly("missed", &Packing::missed)
      .def("gathered",
           [](const Packing& self, const std::optional<std::int64_t>& comm) {
             const MPI_Comm here = communicator(comm);
             const py::gil_scoped_release free;
             return self.gathered(here);
           })
      .def("write",
           [](const Packing& self, const std::optional<std::int64_t>& comm, const std::string& path, bool force) {
             const MPI_Comm here = communicator(comm);
             const py::gil_scoped_release free;
             self.write(here, path, force);
           });
}

void define_scene(py::module_& module) {
  py::class_<Scene>(module, "Scene")
      .def_static("from_file",
                  [](const std::string& path, const std::vector<std::string>& set) {
                    start();
                    return Scene::from_file(path, set);
                  })
      .def_static("from_text", &Scene::from_text)
      .def_property_readonly("name", &Scene::name)
      .def_property_readonly("file", &Scene::file)
      .def_property_readonly("effective", &Scene::effective)
      .def_property_readonly("dimension", &Scene::dimension)
      .def_property_readonly("packs", &Scene::packs)
      .def_property_readonly("remarks", &Scene::remarks);
}

/// What is called for the progress: with the GIL, and first for Ctrl-C, which Python only notes while C++ runs.
std::function<void(const Progress&)> listener(const py::object& told) {
  return [told](const Progress& now) {
    const py::gil_scoped_acquire hold;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!told.is_none()) told(now.stage, now.layer, now.share, now.particles, now.height);
  };
}

RunOptions options_of(const std::string& folder, bool force, const std::string& restart, double max_hours) {
  RunOptions options;
  options.folder = folder;
  options.force = force;
  options.restart = restart;
  options.max_hours = max_hours;
  return options;
}

void define_converted(py::module_& module) {
  py::class_<Converted>(module, "Converted")
      .def_readonly("files", &Converted::files)
      .def_readonly("particles", &Converted::particles)
      .def_readonly("volume", &Converted::volume)
      .def_readonly("cut", &Converted::cut)
      .def_readonly("cut_fraction", &Converted::cut_fraction)
      .def_readonly("springs", &Converted::springs);
}

void define_functions(py::module_& module) {
  using Comm = std::optional<std::int64_t>;
  module.def("run", [](const Scene& scene, const Comm& comm, const std::string& folder, bool force,
                       const std::string& restart, double max_hours, const py::object& progress) {
    const MPI_Comm here = communicator(comm);
    RunOptions options = options_of(folder, force, restart, max_hours);
    options.progress = listener(progress);
    const py::gil_scoped_release free;
    return make_packing(scene, here, options);
  });
  module.def("make_ensemble", [](const Scene& scene, const Comm& comm, const std::string& folder, bool force,
                                 const std::string& restart, double max_hours) {
    const MPI_Comm here = communicator(comm);
    const RunOptions options = options_of(folder, force, restart, max_hours);
    const py::gil_scoped_release free;
    return make_ensemble(scene, here, options);
  });
  module.def("check", [](const Scene& scene, const Comm& comm) { return check(scene, communicator(comm)); });
  module.def("estimate", [](const Scene& scene, const Comm& comm, std::int64_t particles, double height,
                            const std::vector<std::optional<double>>& floor, int ranks, bool probe) {
    const MPI_Comm here = communicator(comm);
    const EstimateOptions options{
        .particles = particles, .height = height, .floor = floor, .ranks = ranks, .probe = probe};
    const py::gil_scoped_release free;
    return estimate(scene, here, options);
  });
  module.def("analyze", [](const Comm& comm, const std::string& pack) { return analyze(communicator(comm), pack); });
  module.def("convert",
             [](const Comm& comm, const std::string& pack, const std::string& format, const std::string& file,
                const std::string& trim, const std::string& cut, const std::array<int, 2>& copies, bool force) {
               const MPI_Comm here = communicator(comm);
               const ConvertOptions options{.file = file, .trim = trim, .cut = cut, .copies = copies, .force = force};
               const py::gil_scoped_release free;
               return convert(here, pack, format, options);
             });
  module.def("rank", [](const Comm& comm) { return rank_in(communicator(comm)); });
  module.def("ranks", [](const Comm& comm) { return ranks_of(communicator(comm)); });
  module.def("end", &end);
}

}  // namespace

PYBIND11_MODULE(_core, module) {
  module.doc() = "The compiled part of packmpi";
  module.attr("version") = std::string(version());
  module.attr("git_id") = std::string(git_id());
  define_scene(module);
  define_packing(module);
  define_converted(module);
  define_functions(module);
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(std::move(thrown));
    } catch (const Failure& failure) {
      const py::object make = py::module_::import("packmpi.problem").attr("of_failure");
      const py::object error = make(failure.code(), failure.what(), failure.file(), failure.line(), failure.key());
      PyErr_SetObject(py::type::handle_of(error).ptr(), error.ptr());
    }
  });
}

}  // namespace packmpi
