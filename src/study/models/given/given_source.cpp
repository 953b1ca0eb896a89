#include "study/models/given/given_source.hpp"

#include "mottle/core/error.hpp"

namespace mottle::study {
namespace {

class GivenSource final : public ModelSource {
 public:
  ModelParts make(const std::vector<ParameterTargets>& /*parameters*/, const JointDistribution& /*prior*/,
                  const RunSettings& /*settings*/) const override {
    throw InvalidInput("the model is a function of another program, which alone can run it");
  }
  bool has_targets() const override { return false; }
  std::string target_unit(const std::string& /*target*/, const UnitNames& /*units*/) const override { return ""; }
  bool gives_shapes() const override { return false; }
  bool tracks_by_mac() const override { return false; }
};

}  // namespace

std::shared_ptr<const ModelSource> given_source() {
  return std::make_shared<GivenSource>();
}

}  // namespace mottle::study
