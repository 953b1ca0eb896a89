#include "mottle/model/reference_sizes.hpp"

#include <cmath>
#include <map>
#include <utility>

namespace mottle::model {
namespace {

bool is_component(QuantityKind kind) {
  return kind == QuantityKind::displacement || kind == QuantityKind::rotation ||
         kind == QuantityKind::static_displacement || kind == QuantityKind::static_rotation;
}

}  // namespace

Eigen::VectorXd reference_sizes(const std::vector<Quantity>& outputs, const Eigen::Ref<const Eigen::VectorXd>& values) {
  constexpr double k_near_node = 0.05;  // of the largest component
  std::map<std::pair<QuantityKind, int>, double> largest;
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    const double size = std::abs(values(static_cast<Eigen::Index>(k)));
    double& most = largest[{outputs[k].kind, outputs[k].number}];
    if (std::isfinite(size)) most = std::max(most, size);
  }
  Eigen::VectorXd sizes = values.cwiseAbs();
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    double& size = sizes(static_cast<Eigen::Index>(k));
    const double most = largest[{outputs[k].kind, outputs[k].number}];
    if (is_component(outputs[k].kind) && size < k_near_node * most) size = most;
  }
  return sizes;
}

}  // namespace mottle::model
