// Rigid bodies, interpolations and multipoint constraints as equations between degrees of freedom.
#pragma once

#include <string>
#include <vector>

#include "mottle/fem/finite_element_model.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// Six slots a node, in its displacement system; a scalar point uses the first.
inline int degree_of_freedom(int node, int component) {
  return 6 * node + component;
}

/// u_dependent = sum of coefficient u_k.
struct DependentDegreeOfFreedom {
  struct Term {
    int degree_of_freedom = 0;
    double coefficient = 0.0;
  };

  int degree_of_freedom = 0;
  std::vector<Term> terms = {};
  std::string source = {};  ///< "RBE2 12", for messages
};

/// Directions of a node's displacement components, as columns in basic coordinates.
Eigen::Matrix3d displacement_directions(const FiniteElementModel& model, int node);

/// Every dependent degree of freedom with its equation; the equations may still name one another's dependent ones.
///
/// Throws InvalidInput: independent components of an RBAR that leave it free to move, an RBE3 whose sources cannot
/// carry a rigid-body motion, an equation whose dependent coefficient is zero.
std::vector<DependentDegreeOfFreedom> dependent_degrees_of_freedom(const FiniteElementModel& model);

}  // namespace mottle::fem
