// Numerical routines that stand alone: modes of sparse matrices, shapes, tests of means, methods' options.
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include "bindings.hpp"
#include "calling_thread.hpp"
#include "mottle/dynamics/modes/mac.hpp"
#include "mottle/linalg/sparse/sparse_modes.hpp"
#include "mottle/mottle.hpp"
#include "mottle/stats/tests/hotelling.hpp"

namespace mottle::python {
namespace {

namespace py = pybind11;

py::tuple modes_of(const SparseMatrix& stiffness, const SparseMatrix& mass, int count, double tolerance, bool counts) {
  SparseModes modes =
      CallingThread::run_by_itself([stiffness = stiffness, mass = mass, count, tolerance, counts](const auto* stop) {
        return SparseModeSolver().solve(
            stiffness, mass,
            {.modes = count, .tolerance = tolerance, .counts_below = counts, .measures = false, .stop = stop});
      });
  if (modes.negative_mass) {
    throw InvalidInput(describe(*modes.negative_mass, fmt::format("{} (counted from 0)", modes.negative_mass->row)));
  }
  if (!modes.failure.empty()) throw SystemFailure("the modes were not found: " + modes.failure);
  if (!modes.is_complete()) {
    throw SystemFailure(fmt::format("{} modes were found, but {} eigenvalues lie below {} by the inertia of K - s M",
                                    modes.values.size(), modes.counted_below, modes.counted_at));
  }
  return py::make_tuple(std::move(modes.values), std::move(modes.vectors));
}

py::list methods() {
  py::list all;
  for (const MethodEntry& method : updating_methods()) {
    py::list options;
    for (const OptionDescription& option : method.options) {
      options.append(py::dict(py::arg("name") = option.name, py::arg("unit") = option.unit,
                              py::arg("allowed") = option.allowed, py::arg("default") = option.default_value,
                              py::arg("meaning") = option.meaning));
    }
    all.append(
        py::dict(py::arg("name") = method.name, py::arg("summary") = method.summary, py::arg("options") = options));
  }
  return all;
}

py::dict two_sample_test(const Eigen::VectorXd& mean_a, const Eigen::MatrixXd& covariance_a, int n_a,
                         const Eigen::VectorXd& mean_b, const Eigen::MatrixXd& covariance_b, int n_b, double level) {
  const TwoSampleTest test = hotelling_two_sample(mean_a, covariance_a, n_a, mean_b, covariance_b, n_b, level);
  return py::dict(py::arg("t_squared") = test.t_squared, py::arg("f") = test.f, py::arg("p_value") = test.p_value,
                  py::arg("critical_t_squared") = test.critical_t_squared, py::arg("df1") = test.df1,
                  py::arg("df2") = test.df2, py::arg("rejects") = test.rejects);
}

}  // namespace

void add_statistics(py::module_& module) {
  module.def("modes_of", modes_of, py::arg("stiffness"), py::arg("mass"), py::kw_only(), py::arg("count"),
             py::arg("tolerance"), py::arg("counts"));
  module.def("mac", &modal_assurance_criterion, py::arg("a"), py::arg("b"));
  module.def("optimal_assignment", &optimal_assignment, py::arg("score"));
  module.def("methods", methods);
  module.def("two_sample_test", two_sample_test, py::arg("mean_a"), py::arg("covariance_a"), py::arg("n_a"),
             py::arg("mean_b"), py::arg("covariance_b"), py::arg("n_b"), py::kw_only(), py::arg("level"));
}

}  // namespace mottle::python
