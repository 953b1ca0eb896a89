// The library's errors as exceptions of the package: mottle.errors defines them, so that they have documentation, bases
// and attributes as Python has them.
#include "bindings.hpp"
#include "mottle/core/error.hpp"

namespace mottle::python {

namespace py = pybind11;

void add_errors(py::module_& /*module*/) {
  // NOLINTNEXTLINE(performance-unnecessary-value-param): pybind11 calls it so
  py::register_exception_translator([](std::exception_ptr thrown) {
    const auto raise = [](const char* name, const Error& error) {
      const py::object type = py::module_::import("mottle.errors").attr(name);
      PyErr_SetObject(type.ptr(), py::str(error.what()).ptr());
    };
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const FormatError& error) {
      raise("FormatError", error);
    } catch (const InvalidInput& error) {
      raise("InvalidInput", error);
    } catch (const ModelFailure& error) {
      raise("ModelFailure", error);
    } catch (const SystemFailure& error) {
      raise("SystemFailure", error);
    } catch (const Stopped& error) {
      raise("Stopped", error);
    }
  });
}

}  // namespace mottle::python
