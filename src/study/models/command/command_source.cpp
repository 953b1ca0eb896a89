// [model] of kind "command": a solver that is run by its command.
#include "mottle/core/files.hpp"
#include "mottle/core/text.hpp"
#include "mottle/drivers/command/template_file.hpp"
#include "study/models/command/read_command.hpp"
#include "study/models/model_parts.hpp"
#include "study/models/registry.hpp"

namespace mottle::study {
namespace {

class CommandSource final : public ModelSource {
 public:
  explicit CommandSource(SolverCommand command) : command_(std::move(command)) {}

  ModelParts make(const std::vector<ParameterTargets>& parameters, const JointDistribution& prior,
                  const RunSettings& settings) const override {
    std::vector<std::string> names;
    for (const ParameterTargets& parameter : parameters) names.push_back(parameter.targets.front());
    return make_external(command_, names, prior, settings);
  }

  std::vector<NamedFile> files() const override {
    std::vector<NamedFile> files;
    const auto add = [&](const std::string& key, const std::vector<RunFile>& list) {
      for (std::size_t i = 0; i < list.size(); ++i) {
        files.push_back({"model." + key, fmt::format("{}[{}]", key, i), list[i].source.string(), list[i].source});
      }
    };
    add("templates", command_.templates);
    add("files", command_.files);
    return files;
  }
  std::vector<std::string> programs() const override {
    std::vector<std::string> programs;
    const auto add = [&](const char* key, const CommandLine& line) {
      programs.push_back(fmt::format("{}: {}", key, join(line.arguments, " ")));
    };
    add("model.command", command_.command);
    if (command_.retry_command) add("model.retry_command", *command_.retry_command);
    for (const auto& [name, value] : command_.environment) {
      programs.push_back(fmt::format("model.environment: {}={}", name, value));
    }
    if (command_.scheduler) {
      programs.push_back(
          fmt::format("model.launch: by tasks of {}", drivers::scheduler_name(command_.scheduler->kind)));
    }
    return programs;
  }
  bool keeps_runs() const override { return true; }

  /// The solver's input as a run with these values has it; what the command's arguments alone say is no file.
  std::optional<ExportedModel> export_at(const std::vector<ParameterTargets>& parameters,
                                         const Eigen::VectorXd& values) const override {
    if (command_.templates.empty()) return std::nullopt;
    std::vector<std::string> names;
    for (const ParameterTargets& parameter : parameters) names.push_back(parameter.targets.front());
    ExportedModel exported;
    for (const RunFile& file : command_.templates) {
      const std::string text = file.text ? *file.text : read_file(file.source);
      exported.files.push_back({file.name, drivers::Template(text, file.source.string(), names).fill(values)});
    }
    return exported;
  }
  bool needs_ranks() const override { return command_.needs_ranks; }

  bool has_targets() const override { return false; }
  std::string target_unit(const std::string& /*target*/, const UnitNames& /*units*/) const override { return ""; }

  bool gives_shapes() const override { return command_.shapes.has_value(); }
  bool tracks_by_mac() const override { return gives_shapes(); }

 private:
  SolverCommand command_;
};

}  // namespace

std::shared_ptr<const ModelSource> read_command_source(TomlReader& reader, const std::filesystem::path& folder) {
  auto source = std::make_shared<CommandSource>(read_command(reader, folder));
  reader.finish();
  return source;
}

}  // namespace mottle::study
