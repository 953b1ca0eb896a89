// Which number of a served model's input vectors is which parameter.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mottle/drivers/umbridge/umbridge_server.hpp"
#include "mottle/layers.hpp"

namespace mottle::drivers {

class InputMap {
 public:
  /// @param entries  of the vectors; empty: the parameters in their order
  /// @param sizes    of the model's input vectors
  /// @param names    of the parameters
  /// @throws InvalidInput  sizes that differ, an unknown parameter, one without a place
  InputMap(std::vector<std::vector<InputEntry>> entries, const std::vector<std::size_t>& sizes,
           const std::vector<std::string>& names);

  std::size_t vectors() const { return parameter_at_.size(); }
  /// The input vectors at a parameter vector.
  std::vector<std::vector<double>> input_at(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;

  /// Whether a parameter, or any, has a place in a vector.
  bool acts(Eigen::Index parameter, std::size_t vector) const;
  bool moves(std::size_t vector) const;
  /// d input[vector] / d parameter.
  std::vector<double> direction(Eigen::Index parameter, std::size_t vector) const;
  /// Adds what a derivative with respect to input[vector] is with respect to the parameters.
  void add_gradient(const std::vector<double>& gradient, std::size_t vector,
                    Eigen::Ref<Eigen::RowVectorXd, 0, Eigen::InnerStride<>> row) const;

 private:
  std::vector<std::vector<Eigen::Index>> parameter_at_;  ///< -1: a constant
  std::vector<std::vector<double>> constants_;
};

}  // namespace mottle::drivers
