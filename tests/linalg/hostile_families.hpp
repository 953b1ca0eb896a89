// Families of pencils made to break the certificate of the reduced model, each by one weakness that it might have.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "linalg/sparse_families.hpp"

namespace mottle::test {

using namespace linalg;  // of which these are the tests

/// A family, how its coefficients scatter, and how much the reduced model may learn.
struct HostileFamily {
  std::string name;
  Family family;
  std::function<void(TermCoefficients&, std::mt19937_64&)> scatter;  ///< changes coefficients that are nominal
  int modes = 10;
  int max_vectors = 400;
  double nominal_of_last = 1.0;  ///< of the last stiffness term

  TermCoefficients nominal() const { return nominal_samples(1); }
  TermCoefficients draw(Index samples, unsigned seed) const {
    std::mt19937_64 random(seed);
    TermCoefficients result = nominal_samples(samples);
    scatter(result, random);
    return result;
  }
  ReducedModel trained(double tolerance = 2e-4, unsigned seed = 1) const {
    ReducedModel model(family.terms, nominal(), family.stiffness, family.mass,
                       {.modes = modes, .tolerance = tolerance, .max_vectors = max_vectors});
    model.train(draw(200, seed), 1);
    return model;
  }

 private:
  TermCoefficients nominal_samples(Index samples) const {
    TermCoefficients result = family.constant(samples, 1.0);
    if (result.stiffness.rows() > 0) result.stiffness.bottomRows(1).setConstant(nominal_of_last);
    return result;
  }
};

/// Lowest eigenvalues of a sample's pencil by dense 1 / (lambda - shift), which a singular M does not disturb; empty
/// where K - shift M is not positive definite.
inline VectorXd exact_values(const Family& family, const TermCoefficients& samples, Index sample, int modes) {
  MatrixXd k = family.terms.stiffness_constant, m = family.terms.mass_constant;
  for (std::size_t t = 0; t < family.terms.stiffness.size(); ++t) {
    k += samples.stiffness(static_cast<Index>(t), sample) * MatrixXd(family.terms.stiffness[t]);
  }
  for (std::size_t t = 0; t < family.terms.mass.size(); ++t) {
    m += samples.mass(static_cast<Index>(t), sample) * MatrixXd(family.terms.mass[t]);
  }
  const double shift = 1e-9 * k.trace() / m.trace();
  const Eigen::LLT<MatrixXd> factor(k + shift * m);
  if (factor.info() != Eigen::Success) return {};
  MatrixXd full = m.selfadjointView<Eigen::Lower>();
  factor.matrixL().solveInPlace(full);
  full.transposeInPlace();
  factor.matrixL().solveInPlace(full);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(full, Eigen::EigenvaluesOnly);
  return solver.eigenvalues().tail(modes).reverse().cwiseInverse().array() - shift;
}

/// Sums terms; all of the nominal coefficients one but the last stiffness term's.
inline HostileFamily hostile(std::string name, int size, const Entries& constant, const std::vector<Entries>& stiffness,
                             const Entries& mass_constant, const std::vector<Entries>& mass,
                             std::function<void(TermCoefficients&, std::mt19937_64&)> scatter,
                             double nominal_of_last = 1.0) {
  HostileFamily result{std::move(name), {}, std::move(scatter), 10, 400, nominal_of_last};
  Family& family = result.family;
  family.terms.stiffness_constant = matrix_of(size, constant);
  family.terms.mass_constant = matrix_of(size, mass_constant);
  for (const Entries& entries : stiffness) family.terms.stiffness.push_back(matrix_of(size, entries));
  for (const Entries& entries : mass) family.terms.mass.push_back(matrix_of(size, entries));
  family.stiffness = family.terms.stiffness_constant;
  family.mass = family.terms.mass_constant;
  for (std::size_t t = 0; t < stiffness.size(); ++t) {
    family.stiffness += (t + 1 == stiffness.size() ? nominal_of_last : 1.0) * family.terms.stiffness[t];
  }
  for (const SparseMatrix& term : family.terms.mass) family.mass += term;
  return result;
}

inline std::function<void(TermCoefficients&, std::mt19937_64&)> lognormal_scatter(double variation) {
  return [variation](TermCoefficients& samples, std::mt19937_64& random) {
    std::lognormal_distribution<double> distribution(0.0, variation);
    for (double& value : samples.stiffness.reshaped()) value *= distribution(random);
    for (double& value : samples.mass.reshaped()) value *= distribution(random);
  };
}

/// Of the first stiffness or mass terms lognormal, of the last stiffness (or mass) term normal.
inline std::function<void(TermCoefficients&, std::mt19937_64&)> normal_last(double standard_deviation,
                                                                            bool is_mass = false) {
  return [standard_deviation, is_mass](TermCoefficients& samples, std::mt19937_64& random) {
    std::lognormal_distribution<double> others(0.0, 0.1);
    std::normal_distribution<double> last(0.0, standard_deviation);
    for (MatrixXd* side : {&samples.stiffness, &samples.mass}) {
      const Index rows = side->rows();
      for (Index s = 0; s < side->cols(); ++s) {
        for (Index t = 0; t < rows; ++t) {
          const bool is_last = t + 1 == rows && (side == &samples.mass) == is_mass;
          (*side)(t, s) = is_last ? (*side)(t, s) + last(random) : (*side)(t, s) * others(random);
        }
      }
    }
  };
}

inline void add_chain(Entries& entries, int first, int count, double stiffness) {
  for (int i = first; i + 1 < first + count; ++i) add_spring(entries, i, i + 1, stiffness);
}

inline void add_diagonal(Entries& entries, int first, int count, double value) {
  for (int i = first; i < first + count; ++i) entries.emplace_back(i, i, value);
}

/// A chain held at its beginning, in parts that are a term each.
inline std::vector<Entries> chain_in_parts(int first, int count, int parts, double stiffness) {
  std::vector<Entries> terms(static_cast<std::size_t>(parts));
  terms[0].emplace_back(first, first, stiffness);
  for (int i = 0; i + 1 < count; ++i) {
    add_spring(terms[static_cast<std::size_t>(i * parts / count)], first + i, first + i + 1, stiffness);
  }
  return terms;
}

/// Where the band of a chain of `count` unit masses and springs, held at one end, ends: its root `mode`.
inline double chain_root(int count, double mode) {
  return std::pow(2.0 * std::sin(0.5 * M_PI * (mode - 0.5) / (count + 0.5)), 2);
}

/// A chain, and a row of masses on springs of their own above the band: a tension takes from these and gives to a
/// larger third part, so that its trace is positive. Where it is large, they fall into the band.
inline HostileFamily tension_of_both_signs(int part, double coupling) {
  Entries constant, tension, masses;
  std::vector<Entries> terms = chain_in_parts(0, part, 3, 1.0);
  const int few = part / 4;
  const double above = 1.2 * chain_root(part, 18);
  add_diagonal(constant, part, few, 2.0 * above);
  add_chain(constant, part, few, 0.01 * above);
  add_diagonal(tension, part, few, -above);
  add_diagonal(tension, part + few, part, 30.0 * above);
  add_chain(constant, part + few, part, 0.3);
  if (coupling != 0.0) add_spring(constant, part - 1, part, coupling * above);
  add_diagonal(masses, 0, 2 * part + few, 1.0);
  terms.push_back(tension);
  return hostile(coupling == 0.0 ? "tension of both signs" : "tension of both signs, weakly coupled", 2 * part + few,
                 constant, terms, masses, {}, normal_last(0.35));
}

/// The same with mass: what is taken from one part is put on another. Where little is taken, the first falls into the
/// band.
inline HostileFamily mass_moved(int part, double coupling) {
  Entries constant, masses, moved;
  const int few = part / 4;
  const double above = 1.2 * chain_root(part, 18);
  add_diagonal(constant, part, few, 0.2 * above);
  add_chain(constant, part, few, 0.002 * above);
  add_diagonal(constant, part + few, part, 30.0 * above);
  if (coupling != 0.0) add_spring(constant, part - 1, part, coupling * above);
  add_diagonal(masses, 0, 2 * part + few, 1.0);
  add_diagonal(moved, part, few, -0.8);
  add_diagonal(moved, part + few, part, 0.8);
  const auto scatter = [](TermCoefficients& samples, std::mt19937_64& random) {
    normal_last(0.4, true)(samples, random);
    samples.mass = samples.mass.cwiseMin(1.2);  // none is negative
  };
  return hostile(coupling == 0.0 ? "mass moved between parts" : "mass moved between parts, weakly coupled",
                 2 * part + few, constant, chain_in_parts(0, part, 3, 1.0), masses, {moved}, scatter);
}

/// Columns under their own weight: bending less load times geometric stiffness, up to near buckling.
inline HostileFamily loaded_columns(int count) {
  Entries bending, load, masses;
  constexpr int k_columns = 3;
  for (int c = 0; c < k_columns; ++c) {
    const int first = c * count;
    bending.emplace_back(first, first, 4.0);
    for (int i = 1; i + 1 < count; ++i) {  // (u_{i-1} - 2 u_i + u_{i+1})^2
      const int a = first + i;
      bending.emplace_back(a - 1, a - 1, 1.0);
      bending.emplace_back(a, a, 4.0);
      bending.emplace_back(a + 1, a + 1, 1.0);
      bending.emplace_back(a, a - 1, -2.0);
      bending.emplace_back(a + 1, a, -2.0);
      bending.emplace_back(a + 1, a - 1, 1.0);
    }
    bending.emplace_back(first + 1, first + 1, 1.0);
    const double critical = std::pow(0.5 * M_PI / count, 2) * (1.0 + 0.02 * c);
    add_chain(load, first, count, -0.6 * critical);
    load.emplace_back(first, first, -0.6 * critical);
    if (c > 0) add_spring(bending, first + count - 1, first - 1, 1e-4 * critical);
    add_diagonal(masses, first, count, 1.0 + 0.1 * c);
  }
  return hostile("columns near buckling", k_columns * count, {}, {bending, load}, masses, {}, normal_last(0.25));
}

/// A preload that is zero at the prior's mean and has either sign in samples.
inline HostileFamily preload_around_zero(int length, int width) {
  const Family base = grid({.length = length, .width = width, .patches = 2});
  const int size = length * width;
  Entries preload;
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  for (int i = 0; i + width < size; ++i) add_spring(preload, i, i + width, 0.1 * normal(random));
  HostileFamily result{"preload around zero", base, normal_last(0.15), 10, 400, 0.0};
  result.family.terms.stiffness.push_back(matrix_of(size, preload));
  result.family.stiffness += 0.0 * result.family.terms.stiffness.back();
  return result;
}

/// Chains with a parameter each: their modes cross everywhere, and one chain's band is above the others'.
inline HostileFamily subsystems(int count, double coupling, double variation) {
  Entries constant, masses;
  std::vector<Entries> chains;
  for (int c = 0; c < 3; ++c) {
    for (Entries& part : chain_in_parts(c * count, count, 2, c == 2 ? 12.0 : 1.0 + 0.05 * c)) chains.push_back(part);
    if (c > 0 && coupling != 0.0) add_spring(constant, c * count - 1, c * count, coupling);
    add_diagonal(masses, c * count, count, 1.0);
  }
  return hostile(coupling == 0.0 ? "decoupled subsystems" : "weakly coupled subsystems", 3 * count, constant, chains,
                 masses, {}, lognormal_scatter(variation));
}

/// A symmetric structure whose parameters keep the symmetry: half of its modes share nothing with the others.
inline HostileFamily symmetric_halves(int count, double link) {
  constexpr std::size_t k_parts = 3;
  Entries links, masses;
  std::vector<Entries> terms(k_parts);
  for (int half = 0; half < 2; ++half) {
    const std::vector<Entries> parts = chain_in_parts(half * count, count, k_parts, 1.0);
    for (std::size_t t = 0; t < k_parts; ++t) terms[t].insert(terms[t].end(), parts[t].begin(), parts[t].end());
    add_diagonal(masses, half * count, count, 1.0);
  }
  for (int i = 0; i < count; ++i) add_spring(links, i, count + i, link);
  terms.push_back(links);
  return hostile("symmetric halves", 2 * count, {}, terms, masses, {}, lognormal_scatter(0.3));
}

/// Equal chains that part a little: roots in pairs, of which one is the last that is wanted.
inline HostileFamily pairs_at_the_edge(int count, double variation) {
  Entries masses;
  std::vector<Entries> terms = chain_in_parts(0, count, 3, 1.0);
  for (const Entries& part : chain_in_parts(count, count, 3, 1.0)) terms.push_back(part);
  add_diagonal(masses, 0, 2 * count, 1.0);
  HostileFamily result =
      hostile("pairs at the band's edge", 2 * count, {}, terms, masses, {}, lognormal_scatter(variation));
  result.modes = 9;
  return result;
}

/// A body on soft springs with a joint that is hardly there in some samples.
inline HostileFamily near_mechanism(int count) {
  Entries soft, joint, masses;
  soft.emplace_back(2 * count - 1, 2 * count - 1, 1e-7);
  std::vector<Entries> terms = chain_in_parts(0, count, 2, 1.0);
  terms[0].erase(terms[0].begin());  // it floats
  soft.emplace_back(0, 0, 1e-7);
  std::vector<Entries> right = chain_in_parts(count, count, 2, 1.3);
  right[0].erase(right[0].begin());
  terms.insert(terms.end(), right.begin(), right.end());
  add_spring(joint, count - 1, count, 1e-3);
  terms.push_back(joint);
  add_diagonal(masses, 0, 2 * count, 1.0);
  return hostile("near-mechanism", 2 * count, soft, terms, masses, {}, lognormal_scatter(0.5));
}

/// Stiff chains on suspensions so soft that rounding leaves the chains' own definiteness open, by more than a bound may
/// neglect; beside them chains that are a term each.
inline HostileFamily soft_suspensions(int count, int chains) {
  Entries constant, masses;
  std::vector<Entries> terms(2);
  for (int c = 0; c < chains; ++c) {
    add_chain(constant, c * count, count, 1.0 + 0.03 * c);
    terms[static_cast<std::size_t>(c % 2)].emplace_back(c * count, c * count, 1e-11);
  }
  for (const Entries& part : chain_in_parts(chains * count, count, 2, 0.5)) terms.push_back(part);
  add_diagonal(masses, 0, (chains + 1) * count, 1.0);
  HostileFamily result =
      hostile("soft suspensions", (chains + 1) * count, constant, terms, masses, {}, lognormal_scatter(0.7));
  result.modes = 16;
  return result;
}

/// Masses of one in 10^8 and none at all among others.
inline HostileFamily light_masses(int count) {
  Entries left, right, heavy, light;
  left.emplace_back(0, 0, 1.0);
  add_chain(left, 0, count, 1.0);
  add_chain(right, count - 1, count + 1, 1.0);
  for (int i = 0; i < 2 * count; ++i) {
    if (i % 3 == 0) heavy.emplace_back(i, i, 1.0);
    if (i % 3 == 1) light.emplace_back(i, i, 1e-8);
  }
  return hostile("masses near zero", 2 * count, {}, {left, right}, {}, {heavy, light}, lognormal_scatter(0.3));
}

/// Every coefficient uniform over a factor of fifty.
inline HostileFamily wide_uniform(int length, int width, bool moves_mass) {
  HostileFamily result{moves_mass ? "uniform over a factor of 50, masses too" : "uniform over a factor of 50",
                       grid({.length = length, .width = width, .patches = 3, .moves_mass = moves_mass}),
                       [](TermCoefficients& samples, std::mt19937_64& random) {
                         std::uniform_real_distribution<double> distribution(0.04, 2.0);
                         for (double& value : samples.stiffness.reshaped()) value = distribution(random);
                         for (double& value : samples.mass.reshaped()) value = distribution(random);
                       },
                       10,
                       400,
                       1.0};
  return result;
}

/// One sample in a thousand has a patch of a hundredth of its stiffness.
inline HostileFamily one_soft_in_a_thousand(int length, int width) {
  return {"one soft sample in a thousand",
          grid({.length = length, .width = width}),
          [](TermCoefficients& samples, std::mt19937_64& random) {
            lognormal_scatter(0.1)(samples, random);
            for (Index s = 0; s < samples.samples(); ++s) {
              if (random() % 1000 == 0) samples.stiffness(static_cast<Index>(random() % 4), s) *= 0.01;
            }
          },
          10,
          400,
          1.0};
}

/// A basis that may not grow: it knows what the nominal modes know, and little else.
inline HostileFamily blind_basis(int count, double coupling) {
  HostileFamily result = subsystems(count, coupling, 0.1);
  result.name = "basis that may not grow";
  result.max_vectors = 24;
  return result;
}

/// A body that floats, with springs of both signs between its points: rigid motions stay free.
inline HostileFamily free_body_with_tension(int length, int width) {
  const int size = length * width;
  HostileFamily result{"free body with tension",
                       grid({.length = length, .width = width, .is_free = true, .moves_mass = true}),
                       normal_last(0.5),
                       10,
                       400,
                       1.0};
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal(0.02, 0.1);
  Entries tension;
  for (int i = 0; i + width < size; ++i) add_spring(tension, i, i + width, normal(random));
  result.family.terms.stiffness.push_back(matrix_of(size, tension));
  result.family.stiffness += result.family.terms.stiffness.back();
  return result;
}

/// Oscillators whose roots are a little above the band's edge, linked so weakly that a basis which may not grow does
/// not know most of them. Nothing is ever softer than at the nominal sample, so that the reference pencil is as near as
/// can be.
inline HostileFamily oscillators_above_the_edge(int count, double above, double link) {
  Entries constant, links, masses;
  constant.emplace_back(0, 0, 1.0);
  add_chain(constant, 0, count, 1.0);
  constexpr int k_oscillators = 24;
  for (int i = 0; i < k_oscillators; ++i) {
    constant.emplace_back(count + i, count + i, chain_root(count, 10) * above * (1.0 + 1e-3 * i));
    add_spring(links, 7 + count / 30 * i, count + i, link);
  }
  add_diagonal(masses, 0, count + k_oscillators, 1.0);
  HostileFamily result = hostile("oscillators above the edge", count + k_oscillators, constant, {links}, masses, {},
                                 [](TermCoefficients& samples, std::mt19937_64& random) {
                                   std::lognormal_distribution<double> distribution(0.0, 2.0);
                                   for (double& value : samples.stiffness.reshaped()) {
                                     value = std::max(1.0, distribution(random));
                                   }
                                 });
  result.max_vectors = 20;
  return result;
}

/// Random terms: of low rank, definite or of both signs, as stiffness and mass, around a pencil that is definite.
inline HostileFamily random_terms(int size, unsigned seed, bool with_mass) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_int_distribution<int> row(0, size - 1);
  const auto rank_one_terms = [&](int count, bool is_definite, double scale) {
    Entries entries;
    for (int c = 0; c < count; ++c) {
      const double sign = is_definite || normal(random) > 0.0 ? 1.0 : -1.0;
      std::vector<std::pair<int, double>> vector;
      for (int i = 0; i < 3; ++i) vector.emplace_back(row(random), normal(random));
      for (const auto& [i, x] : vector) {
        for (const auto& [j, y] : vector) {
          if (i >= j) entries.emplace_back(i, j, sign * scale * x * y);
        }
      }
    }
    return entries;
  };
  Entries constant, masses;
  for (int i = 0; i < size; ++i) {
    constant.emplace_back(i, i, std::pow(10.0, 3.0 * i / size));
    masses.emplace_back(i, i, 1.0 + 0.5 * std::abs(normal(random)));
  }
  std::vector<Entries> stiffness, mass;
  for (int t = 0; t < 4; ++t) {
    stiffness.push_back(rank_one_terms(size / 4, t % 2 == 0, t % 2 == 0 ? 1.0 : 0.05));
    if (with_mass && t < 2) mass.push_back(rank_one_terms(size / 4, t == 0, 0.03));
  }
  return hostile(with_mass ? "random terms, masses too" : "random terms", size, constant, stiffness, masses, mass,
                 lognormal_scatter(0.3));
}

}  // namespace mottle::test
