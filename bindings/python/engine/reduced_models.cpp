// Certified reduced models of a user's matrices.
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <memory>

#include "bindings.hpp"
#include "calling_thread.hpp"
#include "mottle/core/parallel.hpp"
#include "mottle/linalg/reduced/reduced_model.hpp"
#include "mottle/mottle.hpp"

namespace mottle::python {
namespace {

namespace py = pybind11;
using linalg::CertifiedModes;
using linalg::PencilTerms;
using linalg::ReducedModel;
using linalg::ReducedModelOptions;
using linalg::TermCoefficients;

/// Coefficients of the terms of K, then of those of M [term x sample].
TermCoefficients split(const Eigen::MatrixXd& coefficients, std::size_t stiffness_terms) {
  const auto first = static_cast<Eigen::Index>(stiffness_terms);
  return {coefficients.topRows(first), coefficients.bottomRows(coefficients.rows() - first)};
}

/// The sum at one sample, in a pattern that holds all terms'.
SparseMatrix sum_of(const SparseMatrix& constant, const std::vector<SparseMatrix>& terms,
                    const Eigen::VectorXd& coefficients) {
  SparseMatrix sum = constant;
  for (std::size_t t = 0; t < terms.size(); ++t) {
    sum = SparseMatrix(sum + coefficients(static_cast<Eigen::Index>(t)) * terms[t]);
  }
  sum.makeCompressed();
  return sum;
}

int threads_or_all(int threads) {
  return threads > 0 ? threads : available_threads();
}

/// A trained model, not changed any more.
struct TrainedModel {
  ReducedModel model;
  std::size_t stiffness_terms = 0;
};

std::shared_ptr<TrainedModel> train(PencilTerms terms, const Eigen::VectorXd& nominal, const Eigen::MatrixXd& training,
                                    const ReducedModelOptions& options, int threads) {
  return CallingThread::run_by_itself([=, terms = std::move(terms)](const std::atomic<bool>* stop) {
    const std::size_t count = terms.stiffness.size();
    const TermCoefficients at = split(nominal, count);
    const RunContext context{.stop = stop};
    auto trained = std::make_shared<TrainedModel>(
        TrainedModel{ReducedModel(terms, at, sum_of(terms.stiffness_constant, terms.stiffness, at.stiffness),
                                  sum_of(terms.mass_constant, terms.mass, at.mass), options),
                     count});
    trained->model.train(split(training, count), threads_or_all(threads),
                         [&](Eigen::Index /*vectors*/) { context.throw_if_stopped(); });
    return trained;
  });
}

/// By blocks, between which it can be stopped.
CertifiedModes solve(const std::shared_ptr<const TrainedModel>& trained, const Eigen::MatrixXd& coefficients,
                     int threads) {
  constexpr Eigen::Index k_block = 1024;
  return CallingThread::run_by_itself([=](const std::atomic<bool>* stop) {
    const TermCoefficients all = split(coefficients, trained->stiffness_terms);
    const RunContext context{.stop = stop};
    CertifiedModes found;
    for (Eigen::Index first = 0; first < all.samples() || first == 0; first += k_block) {
      context.throw_if_stopped();
      const CertifiedModes block =
          trained->model.solve(all.range(first, std::min(k_block, all.samples() - first)), threads_or_all(threads));
      if (first == 0) {
        found.values.resize(block.values.rows(), all.samples());
        found.vectors.resize(block.vectors.rows(), all.samples());
        found.bounds.resize(block.bounds.rows(), all.samples());
      }
      found.values.middleCols(first, block.values.cols()) = block.values;
      found.vectors.middleCols(first, block.vectors.cols()) = block.vectors;
      found.bounds.middleCols(first, block.bounds.cols()) = block.bounds;
    }
    return found;
  });
}

}  // namespace

void add_reduced_models(py::module_& module) {
  py::class_<TrainedModel, std::shared_ptr<TrainedModel>> model(module, "ReducedModel");
  model.def(py::init([](const SparseMatrix& stiffness_constant, const std::vector<SparseMatrix>& stiffness,
                        const SparseMatrix& mass_constant, const std::vector<SparseMatrix>& mass,
                        const Eigen::VectorXd& nominal, const Eigen::MatrixXd& training, int modes, double tolerance,
                        int max_vectors, int threads) {
              return train({.stiffness_constant = stiffness_constant,
                            .stiffness = stiffness,
                            .mass_constant = mass_constant,
                            .mass = mass},
                           nominal, training, {.modes = modes, .tolerance = tolerance, .max_vectors = max_vectors},
                           threads);
            }),
            py::arg("stiffness_constant"), py::arg("stiffness"), py::arg("mass_constant"), py::arg("mass"),
            py::kw_only(), py::arg("nominal"), py::arg("training"), py::arg("modes"), py::arg("tolerance"),
            py::arg("max_vectors"), py::arg("threads"));
  model.def(
      "solve",
      [](const std::shared_ptr<TrainedModel>& self, const Eigen::MatrixXd& coefficients, int threads) {
        CertifiedModes found = solve(self, coefficients, threads);
        return py::make_tuple(std::move(found.values), std::move(found.bounds), std::move(found.vectors));
      },
      py::arg("coefficients"), py::kw_only(), py::arg("threads"));
  model.def_property_readonly(
      "basis", [](const TrainedModel& self) -> const Eigen::MatrixXd& { return self.model.basis(); },
      py::return_value_policy::reference_internal);
  model.def_property_readonly("reaches_tolerance",
                              [](const TrainedModel& self) { return self.model.reaches_tolerance(); });
  model.def_property_readonly("has_indefinite_terms",
                              [](const TrainedModel& self) { return self.model.has_indefinite_terms(); });
}

}  // namespace mottle::python
