// A small structure with full matrices.
#pragma once

#include "mottle/layers.hpp"
#include "mottle/model/structures/affine_matrices.hpp"
#include "mottle/model/structures/structure.hpp"

namespace mottle::model {

class DenseStructure final : public Structure {
 public:
  DenseStructure(AffineStructure matrices, Eigen::Index parameters)
      : matrices_(std::move(matrices)), parameters_(parameters) {}

  Eigen::Index parameter_count() const override { return parameters_; }
  Eigen::Index mode_count() const override { return matrices_.stiffness.constant.rows(); }
  bool is_damped() const override;
  int find_degree_of_freedom(const std::string& name) const override;
  std::string unknown_degree_of_freedom(const std::string& name) const override;
  ObservationMatrix observation(const std::vector<int>& degrees_of_freedom) const override {
    return selected_equations(degrees_of_freedom, mode_count());
  }
  double total_mass(const Eigen::Ref<const Eigen::VectorXd>& parameters) const override;
  std::vector<std::string> description(const Eigen::Ref<const Eigen::VectorXd>& parameters) const override;
  std::string parameter_role(Eigen::Index) const override { return "linearly: no re-assembly"; }

  const AffineStructure& matrices() const { return matrices_; }

 private:
  AffineStructure matrices_;
  Eigen::Index parameters_;
};

}  // namespace mottle::model
