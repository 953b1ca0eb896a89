// A structure with parameters: its degrees of freedom, its mass and how the parameters enter. Its equations are solved
// by a Solver.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::fem {
struct FiniteElementModel;
}  // namespace mottle::fem

namespace mottle::model {

/// Stiffness, mass and damping as functions of the parameters, or an external program that knows them. Shapes have
/// a row for each equation; the degrees of freedom that a user names are found by number and read off by
/// `displacements`.
class Structure {
 public:
  virtual ~Structure() = default;

  virtual Eigen::Index parameter_count() const = 0;
  /// Equations, or modes where no more is known: the most modes there can be.
  virtual Eigen::Index mode_count() const = 0;
  virtual bool is_damped() const { return false; }

  /// Number of a degree of freedom by its name, or -1.
  virtual int find_degree_of_freedom(const std::string& name) const = 0;
  /// "'m9' is not known here; ...": what a wrong name is answered with.
  virtual std::string unknown_degree_of_freedom(const std::string& name) const = 0;
  /// Components of shapes [equation x mode] at degrees of freedom: [degree of freedom x mode].
  virtual Eigen::MatrixXd displacements(const Eigen::Ref<const Eigen::MatrixXd>& shapes,
                                        const std::vector<int>& degrees_of_freedom) const = 0;

  /// Total mass at one parameter vector; nan where it is not known.
  virtual double total_mass(const Eigen::Ref<const Eigen::VectorXd>& parameters) const = 0;
  /// Description of the structure as it was read, in lines for `check`.
  virtual std::vector<std::string> description(const Eigen::Ref<const Eigen::VectorXd>& parameters) const = 0;
  /// How a parameter enters: "linearly: no re-assembly".
  virtual std::string parameter_role(Eigen::Index parameter) const = 0;

  /// Grid points and elements, for drawing and for directions of measured components; null: it has none. Where it has,
  /// component c of node i is degree of freedom 6 i + c.
  virtual const FiniteElementModel* mesh() const { return nullptr; }
};

}  // namespace mottle::model
