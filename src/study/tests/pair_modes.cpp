#include "study/tests/pair_modes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "study/input/first_few.hpp"
#include "study/tests/mistaken_sensors.hpp"
#include "study/tests/specimen_pairing.hpp"

namespace mottle::study {
namespace {

/// The format states components in the node's own axes, but some programs write global ones.
void settle_axes(const StructureModel& model, MeasuredModes& modes, std::vector<std::string>& notes) {
  constexpr double k_telling = 0.01;  // a mode
  MeasuredModes global = modes;
  for (MeasuredComponent& component : global.components) component.direction = Eigen::Vector3d::Unit(component.axis);
  const double own_total = total_mac(model, modes);
  const double global_total = total_mac(model, global);
  const double needed = k_telling * static_cast<double>(modes.frequencies.size());
  const bool is_global = global_total > own_total + needed;
  const bool is_told = std::abs(global_total - own_total) > needed;
  notes.push_back(fmt::format("{}: shapes taken in {} (sum of MAC {:.2f}, in {} {:.2f}){}.", modes.file,
                              is_global ? "global axes" : "the nodes' own axes", is_global ? global_total : own_total,
                              is_global ? "the nodes' own" : "global ones", is_global ? own_total : global_total,
                              is_told ? "" : ", which the shapes do not decide"));
  if (is_global) modes = std::move(global);
}

/// The rows of the table as columns.
struct Table {
  std::vector<std::array<double, 7>> numbers;
  std::vector<std::string> files, verdicts, reasons;

  void add(std::size_t specimen, const MeasuredModes& modes, const PairingRow& row) {
    constexpr double k_none = std::numeric_limits<double>::quiet_NaN();
    const bool is_there = row.test >= 0;
    numbers.push_back({static_cast<double>(specimen), static_cast<double>(row.mode),
                       is_there ? static_cast<double>(row.test + 1) : k_none,
                       is_there ? modes.frequencies(row.test) : k_none, row.mac, row.second_mac,
                       is_there ? modes.collinearity(row.test) : k_none});
    files.push_back(std::filesystem::path(modes.file).filename().string());
    verdicts.push_back(row.verdict);
    reasons.push_back(row.reason);
  }

  std::string csv() const {
    Eigen::MatrixXd values(static_cast<Eigen::Index>(numbers.size()), 7);
    for (std::size_t row = 0; row < numbers.size(); ++row) {
      values.row(static_cast<Eigen::Index>(row)) = Eigen::Map<const Eigen::RowVectorXd>(numbers[row].data(), 7);
    }
    return format_csv({"specimen", "mode", "test_mode", "frequency", "mac", "second_mac", "collinearity", "file",
                       "verdict", "reason"},
                      values, {files, verdicts, reasons});
  }
};

/// "105:+Z", in the node's own axes where it has some.
std::vector<std::string> sensors_of(const MeasuredModes& modes) {
  std::vector<std::string> names;
  for (const MeasuredComponent& one : modes.components) {
    names.push_back(one.name.empty() ? fmt::format("{}:+{}{}", one.node, one.is_rotation ? "R" : "", "XYZ"[one.axis])
                                     : one.name);
  }
  return names;
}

void add_note(std::vector<std::string>& notes, const char* what, const std::vector<std::string>& remarks) {
  if (!remarks.empty()) notes.push_back(fmt::format("{}: {}.", what, first_few(remarks)));
}

}  // namespace

PairedModes pair_modes(const StructureModel& model, const std::vector<MeasuredModes>& specimens, bool by_mac) {
  PairedModes paired;
  paired.values = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(specimens.size()),
                                            static_cast<Eigen::Index>(model.measured().size()), std::nan(""));
  Table table;
  std::vector<std::string> missing;
  std::vector<std::string> doubtful;
  std::vector<std::string> unknown;
  std::vector<std::string> unsized;
  std::vector<ComparedShape> shapes;
  const std::vector<std::string> sensors =
      specimens.empty() ? std::vector<std::string>{} : sensors_of(specimens.front());
  for (std::size_t s = 0; s < specimens.size(); ++s) {
    MeasuredModes modes = specimens[s];
    if (by_mac && modes.has_own_axes) settle_axes(model, modes, paired.notes);
    const SpecimenPairing pairing(model, modes, by_mac);
    pairing.fill(paired.values.row(static_cast<Eigen::Index>(s)));
    if (pairing.unknown_components() > 0) {
      unknown.push_back(fmt::format("{} of specimen {}", pairing.unknown_components(), s + 1));
    }
    for (const int mode : pairing.modes_without_size())
      unsized.push_back(fmt::format("specimen {} mode {}", s + 1, mode));
    for (const PairingRow& row : pairing.rows()) {
      table.add(s + 1, modes, row);
      const std::string name = fmt::format("specimen {} mode {}", s + 1, row.mode);
      if (row.verdict == "missing") missing.push_back(name);
      if (row.verdict == "doubtful") doubtful.push_back(fmt::format("{} ({})", name, row.reason));
    }
    if (by_mac && sensors_of(modes) == sensors) {
      for (ComparedShape& shape : pairing.compared_shapes()) shapes.push_back(std::move(shape));
    }
    paired.specimens.push_back({std::move(modes), pairing.assigned()});
  }
  if (!shapes.empty()) paired.mistaken_sensors = mistaken_sensors(shapes, sensors);
  paired.table = table.csv();
  add_note(paired.notes, "Modes that were not found", missing);
  add_note(paired.notes, "Doubtful pairs, used nevertheless", doubtful);
  add_note(paired.notes, "Measured components that the model does not have", unknown);
  add_note(
      paired.notes,
      "Shapes without modal mass, of which only the frequencies are used (outputs.shapes.size = \"free\" compares the "
      "directions of all shapes)",
      unsized);
  return paired;
}

}  // namespace mottle::study
