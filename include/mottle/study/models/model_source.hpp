// [model] of a study: the interface of the kinds of model. A folder a kind in src/study/models, a line a kind in
// src/study/models/registry.cpp.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/model/parameters/parameter_targets.hpp"
#include "mottle/model/solvers/solver.hpp"
#include "mottle/model/structures/sparse_structure.hpp"
#include "mottle/model/units.hpp"
#include "mottle/stats/distributions/joint_distribution.hpp"
#include "mottle/study/models/program_runs.hpp"
#include "mottle/study/run_settings.hpp"

namespace mottle::study {

/// A structure, as sparse matrices or with its solver, and what belongs to it.
struct ModelParts {
  std::unique_ptr<SparseStructure> sparse = nullptr;
  std::unique_ptr<Solver> solver = nullptr;
  Eigen::VectorXd reference = {};           ///< parameters at which modes are numbered
  std::vector<PhysicalLimit> limits = {};   ///< [parameter]
  std::vector<std::string> files = {};      ///< that it was read from
  std::vector<std::string> notes = {};      ///< what a reader of the model should know
  std::optional<ProgramRuns> program = {};  ///< of a model each of whose solutions is a run of a program
};

/// A number of the model that a parameter may stand for.
struct ModelNumber {
  std::string target;
  std::string kind;  ///< numbers of one kind are of one size: "spring", "PELAS:K"
  double value = 0.0;
  bool is_usual = false;    ///< a candidate of a diagnosis by default
  bool is_doubtful = true;  ///< errors in it are looked for behind a verdict
  bool is_single = true;    ///< else it stands for several different values of the model, of which `value` is the first
};

/// A file that [model] names.
struct NamedFile {
  std::string label;           ///< for messages: "model.file"
  std::string key;             ///< its key in [model]: "file", "terms[0].mass"; empty: beside a file that is named
  std::string location;        ///< resolved against the study's folder; may name a matrix behind a '#'
  std::filesystem::path file;  ///< the same without
};

/// A deck with other numbers, for the solver that it was written for.
struct ExportedModel {
  struct File {
    std::filesystem::path name;  ///< relative to the deck's folder
    std::string bytes;
  };
  std::vector<File> files = {};  ///< the deck first, then what it includes
  double rounding = 0.0;         ///< largest relative difference of a number as written from the one wanted
};

/// The contents of [model] for one kind of model: plain data and queries of it.
class ModelSource {
 public:
  virtual ~ModelSource() = default;

  /// Reads the model's files and makes its structure.
  ///
  /// @throws InvalidInput, FormatError  what the parameters name is not in the model, files that cannot be read
  /// @throws SystemFailure  a program fails at the parameters' means
  virtual ModelParts make(const std::vector<ParameterTargets>& parameters, const JointDistribution& prior,
                          const RunSettings& settings) const = 0;

  /// Relative error of frequencies that a reduced model may make; nothing: none may be used.
  virtual std::optional<double> reduction_error() const { return std::nullopt; }

  virtual std::vector<NamedFile> files() const { return {}; }
  /// What it would run, by key: "model.program: ccx".
  virtual std::vector<std::string> programs() const { return {}; }
  /// Whether runs are kept in folders among the results.
  virtual bool keeps_runs() const { return false; }
  /// Whether jobs are to be done by several ranks only.
  virtual bool needs_ranks() const { return false; }

  /// Whether parameters name what they act on; else their names are placeholders in the input of a program.
  virtual bool has_targets() const { return true; }
  /// A target as it is compared with others: in capitals where letters' case has no meaning.
  virtual std::string target_key(const std::string& target) const { return target; }
  /// Unit of what a parameter acts on: "spring:k1", "MAT1:2:E"; empty: not known.
  virtual std::string target_unit(const std::string& target, const UnitNames& units) const = 0;

  /// Whether numbers() are all numbers of the model.
  virtual bool shows_numbers() const { return false; }
  virtual std::vector<ModelNumber> numbers() const { return {}; }
  /// The same model with another value of one number; `target` as target_key() gives it.
  ///
  /// @throws InvalidInput  this kind has no such numbers; an unknown target may be refused by make() only
  virtual std::unique_ptr<ModelSource> with_number(const std::string& target, double value) const;

  /// The model's deck with the parameters' values in it; nothing: this kind has no deck of its own.
  ///
  /// @param values  [parameter]
  /// @throws InvalidInput, FormatError  a number that cannot be written into the deck, a file outside of its folder
  virtual std::optional<ExportedModel> export_at(const std::vector<ParameterTargets>& /*parameters*/,
                                                 const Eigen::VectorXd& /*values*/) const {
    return std::nullopt;
  }

  virtual bool gives_shapes() const { return true; }
  /// Whether modes are tracked by MAC unless told otherwise.
  virtual bool tracks_by_mac() const { return true; }
  /// Degrees of freedom at which shapes could be measured; empty: not known.
  virtual std::vector<std::string> shape_locations() const { return {}; }
};

}  // namespace mottle::study
