// A model y = a + G x for tests: its answers are known in closed form. It can count its runs and fail at will.
#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "mottle/model/model.hpp"

namespace mottle::test {

using namespace model;  // of which these are the tests

class LinearModel final : public Model {
 public:
  LinearModel(Eigen::VectorXd offset, Eigen::MatrixXd slope) : offset_(std::move(offset)), slope_(std::move(slope)) {
    for (Eigen::Index k = 0; k < offset_.size(); ++k)
      outputs_.push_back(named_quantity(fmt::format("y{}", k + 1), "-"));
  }

  Eigen::Index parameter_count() const override { return slope_.cols(); }
  const std::vector<Quantity>& outputs() const override { return outputs_; }
  Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext&) const override {
    runs += samples.rows();
    Evaluation evaluation;
    evaluation.outputs = (samples * slope_.transpose()).rowwise() + offset_.transpose();
    for (Eigen::Index s = 0; s < samples.rows(); ++s) {
      if (!fails || !fails(samples.row(s))) continue;
      evaluation.outputs.row(s).setConstant(std::numeric_limits<double>::quiet_NaN());
      evaluation.failures.push_back({s, "asked to fail"});
    }
    return evaluation;
  }

  mutable std::int64_t runs = 0;
  std::function<bool(const Eigen::RowVectorXd&)> fails;

 private:
  Eigen::VectorXd offset_;
  Eigen::MatrixXd slope_;
  std::vector<Quantity> outputs_;
};

}  // namespace mottle::test
