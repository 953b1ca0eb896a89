// A small family of sparse pencils with all that a reduced model of it is made from.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <random>
#include <vector>

#include "mottle/linalg/reduced/reduced_model_file.hpp"

namespace mottle::test {

using namespace linalg;  // of which these are the tests

/// A chain of masses with springs in three patches and a pair of springs across one of them; its middle mass moves too.
struct Chain {
  static constexpr int size = 120;
  static constexpr int patches = 3;

  explicit Chain(double middle_mass = 1.0) {
    using Triplets = std::vector<Eigen::Triplet<double>>;
    std::vector<Triplets> springs(patches);
    Triplets ground{{0, 0, 1.0}}, masses, middle{{size / 2, size / 2, middle_mass}};
    for (int i = 0; i < size; ++i) masses.emplace_back(i, i, 1.0);
    for (int i = 0; i + 1 < size; ++i) {
      Triplets& entries = springs[static_cast<std::size_t>(i * patches / size)];
      entries.emplace_back(i, i, 1.0);
      entries.emplace_back(i + 1, i + 1, 1.0);
      entries.emplace_back(i + 1, i, -1.0);
    }
    const auto matrix = [](const Triplets& entries) {
      SparseMatrix result(size, size);
      result.setFromTriplets(entries.begin(), entries.end());
      return result;
    };
    terms = {matrix(ground), {}, matrix(masses), {matrix(middle)}};
    for (const Triplets& entries : springs) terms.stiffness.push_back(matrix(entries));
    stiffness = terms.stiffness_constant;
    for (const SparseMatrix& term : terms.stiffness) stiffness += term;
    mass = terms.mass_constant + terms.mass[0];
    nominal = {Eigen::MatrixXd::Ones(patches, 1), Eigen::MatrixXd::Ones(1, 1)};
    training = samples(80, 0.2, 1);
  }

  static TermCoefficients samples(Eigen::Index count, double variation, unsigned seed) {
    std::mt19937_64 random(seed);
    std::lognormal_distribution<double> distribution(0.0, variation);
    TermCoefficients result{Eigen::MatrixXd(patches, count), Eigen::MatrixXd(1, count)};
    for (double& value : result.stiffness.reshaped()) value = distribution(random);
    for (double& value : result.mass.reshaped()) value = distribution(random);
    return result;
  }

  ReducedModelInputs inputs() const { return {terms, nominal, stiffness, mass, options, training}; }
  std::unique_ptr<ReducedModel> trained() const {
    auto model = std::make_unique<ReducedModel>(terms, nominal, stiffness, mass, options);
    model->train(training, 1);
    return model;
  }

  PencilTerms terms;
  TermCoefficients nominal;
  SparseMatrix stiffness, mass;
  ReducedModelOptions options{.modes = 4, .tolerance = 1e-6};
  TermCoefficients training;
};

}  // namespace mottle::test
