// A small structure with full matrices: all samples of a batch are solved side by side in SIMD lanes.
#pragma once

#include "mottle/linalg/batched/batch_eigen.hpp"
#include "mottle/model/structures/affine_matrices.hpp"
#include "mottle/model/structures/modal_structure.hpp"

namespace mottle {

class DenseStructure final : public ModalStructure {
 public:
  DenseStructure(AffineStructure structure, Eigen::Index parameters);

  Eigen::Index parameter_count() const override { return parameters_; }
  Eigen::Index mode_count() const override { return structure_.stiffness.constant.rows(); }
  bool is_damped() const override;
  int find_degree_of_freedom(const std::string& name) const override;
  std::string unknown_degree_of_freedom(const std::string& name) const override;
  Eigen::MatrixXd displacements(const Eigen::Ref<const Eigen::MatrixXd>& shapes,
                                const std::vector<int>& degrees_of_freedom) const override;
  /// All modes, however many are asked for.
  ModeSet modes_at(const Eigen::Ref<const Eigen::VectorXd>& parameters, int modes) const override;
  SolverUse solve(const Eigen::Ref<const Eigen::MatrixXd>& samples, int modes, const ModalObservation& observation,
                  const RunContext& context, const Visitor& visit) const override;
  Eigen::MatrixXd cosines(const ModeSet& reference, const ModeSet& modes) const override;
  Eigen::MatrixXd eigenvalue_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                         const ModeSet& modes) const override;
  Eigen::MatrixXd shape_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters, const ModeSet& modes,
                                    int mode) const override;
  Eigen::VectorXd damping_ratios(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                 const ModeSet& modes) const override;
  int modes_for_damping(int modes) const override;
  Eigen::Index batch_size() const override { return 8192; }
  double total_mass(const Eigen::Ref<const Eigen::VectorXd>& parameters) const override;
  std::vector<std::string> description(const Eigen::Ref<const Eigen::VectorXd>& parameters) const override;
  std::string parameter_role(Eigen::Index) const override { return "linearly: no re-assembly"; }

 private:
  AffineStructure structure_;
  Eigen::Index parameters_;
  PencilFamily pencils_;
};

}  // namespace mottle
