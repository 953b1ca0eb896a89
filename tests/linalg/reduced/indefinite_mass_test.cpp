// A reduced model of a family whose mass becomes indefinite, where the mass of its basis may stay definite.
#include <gtest/gtest.h>

#include <cmath>

#include "linalg/sparse_families.hpp"
#include "mottle/core/error.hpp"
#include "mottle/linalg/reduced/reduced_model.hpp"

namespace mottle::linalg {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using test::Family;

/// Unit masses, and a term that moves mass from row 141 to row 140: M(b) is indefinite for |b| > 1.
Family moved_mass() {
  Family family = test::grid({});
  family.terms.mass.push_back(test::matrix_of(static_cast<int>(family.size()), {{140, 140, 1.0}, {141, 141, -1.0}}));
  return family;
}

TermCoefficients between(const Family& family, double first, double last) {
  TermCoefficients samples = family.constant(40, 1.0);
  samples.mass.row(0).setLinSpaced(first, last);
  return samples;
}

TEST(ReducedModel, ClaimsNothingWhereTheMassIsNotSemidefinite) {
  const Family family = moved_mass();
  ReducedModel model(family.terms, between(family, 0.0, 0.0).range(0, 1), family.stiffness, family.mass, {.modes = 5});
  model.train(between(family, -0.8, 0.8), 1);
  for (const double sign : {-1.0, 1.0}) {
    const CertifiedModes found = model.solve(between(family, 1.001 * sign, 1.5 * sign), 1);
    EXPECT_TRUE(std::isinf(found.bounds.colwise().maxCoeff().minCoeff())) << sign;
  }
  EXPECT_LT(model.solve(between(family, -0.8, 0.8), 1).bounds.maxCoeff(), 2e-4);  // it does give bounds elsewhere
}

TEST(ReducedModel, RefusesANominalMassThatIsNotSemidefinite) {
  const Family family = moved_mass();
  SparseMatrix mass = family.mass + 1.1 * family.terms.mass[0];
  EXPECT_THROW(ReducedModel(family.terms, between(family, 1.1, 1.1).range(0, 1), family.stiffness, mass, {.modes = 5}),
               InvalidInput);
}

}  // namespace
}  // namespace mottle::linalg
