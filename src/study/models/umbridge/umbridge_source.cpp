// [model] of kind "umbridge": a model behind UM-Bridge servers.
#include <limits>

#include "mottle/drivers/umbridge/umbridge_solver.hpp"
#include "study/input/key_error.hpp"
#include "study/models/registry.hpp"
#include "study/models/umbridge/read_umbridge.hpp"

namespace mottle::study {
namespace {

class UmbridgeSource final : public ModelSource {
 public:
  explicit UmbridgeSource(UmbridgeServer server) : server_(std::move(server)) {}

  ModelParts make(const std::vector<ParameterTargets>& parameters, const JointDistribution& prior,
                  const RunSettings& settings) const override {
    std::vector<std::string> names;
    for (const ParameterTargets& parameter : parameters) names.push_back(parameter.targets.front());
    ModelParts parts;
    parts.reference = prior.mean();
    parts.limits.assign(names.size(), {.lower = -std::numeric_limits<double>::infinity()});
    UmbridgeServer server = server_;
    if (!settings.ends_by_failures) server.max_failed_fraction = 1.0;
    try {
      auto solver = std::make_unique<UmbridgeSolver>(
          server, names, parts.reference,
          RunStorage{.results = settings.run_folder.empty() ? settings.folder : settings.run_folder,
                     .is_resumed = settings.resume,
                     .ranks = settings.ranks},
          settings.stop);
      parts.program = {.max_parallel = server_.parallel,
                       .last_word = [own = solver.get()] { return own->derivatives_note(); }};
      parts.solver = std::move(solver);
    } catch (const UmbridgeFault& fault) {
      throw KeyError("model." + fault.key(), fault.fault());
    }
    return parts;
  }

  /// Servers anywhere are to be as welcome as programs of a stranger's study.
  std::vector<std::string> programs() const override {
    std::vector<std::string> programs;
    for (const HttpAddress& address : server_.urls) programs.push_back("model.urls: " + address.text());
    return programs;
  }
  bool keeps_runs() const override { return true; }

  bool has_targets() const override { return false; }
  std::string target_unit(const std::string& /*target*/, const UnitNames& /*units*/) const override { return ""; }

  bool gives_shapes() const override { return false; }
  bool tracks_by_mac() const override { return false; }

 private:
  UmbridgeServer server_;
};

}  // namespace

std::shared_ptr<const ModelSource> read_umbridge_source(TomlReader& reader, const std::filesystem::path& /*folder*/) {
  auto source = std::make_shared<UmbridgeSource>(read_umbridge(reader));
  reader.finish();
  return source;
}

}  // namespace mottle::study
