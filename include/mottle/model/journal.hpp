// Journal of all finished model evaluations, from which a killed run is resumed: a method is deterministic, so that on
// restart it asks for the same batches and gets them from the journal.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "mottle/core/checksum.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/model.hpp"

namespace mottle::model {

inline constexpr std::string_view k_journal_magic = "mottle journal";  ///< of any version

class JournalFile;

/// A model that answers from its journal where it can and writes there what it had to compute.
///
/// The journal is a sequence of records, each with its own checksum: a record cut off by a kill is dropped, as is
/// everything behind the first record that does not belong to what is asked.
class JournalledModel final : public Model {
 public:
  /// @param model        the model that computes; must outlive this one
  /// @param file         the journal; empty: none is kept
  /// @param fingerprint  of everything the results depend on; kept in the journal's head
  /// @param resume       use what an earlier run left; else start an empty journal
  /// @param ranks        share the evaluation of each batch; all of them ask for the same batches, and only the first
  ///                     one needs a journal. Null: this process is alone. Must outlive this object
  /// Throws InvalidInput: `resume` with a journal of another fingerprint (something has changed since);
  /// SystemFailure: the journal cannot be written; in an evaluation also: the ranks ask for different batches.
  JournalledModel(const Model& model, std::filesystem::path file, const Digest& fingerprint, bool resume,
                  Ranks* ranks = nullptr);
  ~JournalledModel() override;
  JournalledModel(const JournalledModel&) = delete;
  JournalledModel& operator=(const JournalledModel&) = delete;

  Eigen::Index parameter_count() const override { return model_.parameter_count(); }
  const std::vector<Quantity>& outputs() const override { return model_.outputs(); }
  double difference_step() const override { return model_.difference_step(); }
  bool adapts_to_regions() const override { return model_.adapts_to_regions(); }
  Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext& context) const override;
  Evaluation evaluate_in(const SampleRegion& region, const Eigen::Ref<const Eigen::MatrixXd>& samples,
                         const RunContext& context) const override;

  /// The derivatives there, from the journal where an earlier run has asked for them; may be called by several threads.
  ///
  /// @param derivatives  of the model that computes
  Eigen::MatrixXd jacobian_of(const DifferentiableModel& derivatives,
                              const Eigen::Ref<const Eigen::VectorXd>& parameters) const;

  /// Samples answered from the journal of an earlier run.
  std::int64_t reused() const;
  /// How all samples so far were solved.
  const SolverUse& use() const { return use_; }

 private:
  /// Of a batch, part by part; `region` may be null.
  Evaluation evaluate_parts(const SampleRegion* region, const Eigen::Ref<const Eigen::MatrixXd>& samples,
                            const RunContext& context) const;
  Evaluation answer_to(const SampleRegion* region, const Eigen::Ref<const Eigen::MatrixXd>& samples,
                       const RunContext& context) const;
  Evaluation compute(const SampleRegion* region, const Eigen::Ref<const Eigen::MatrixXd>& samples,
                     const RunContext& context) const;
  bool ask_first_rank(const Digest& question, Eigen::Index rows, bool is_known, Evaluation& answer) const;
  const Model& model_;
  Digest fingerprint_;
  std::unique_ptr<JournalFile> file_;
  Ranks* ranks_;
  mutable SolverUse use_;
};

/// Derivatives that are kept in the journal too: for models whose derivatives cost as much as their values.
class JournalledDerivatives final : public DifferentiableModel {
 public:
  /// Both must outlive this object.
  JournalledDerivatives(const JournalledModel& journal, const DifferentiableModel& derivatives)
      : journal_(journal), derivatives_(derivatives) {}

  Eigen::MatrixXd jacobian(const Eigen::Ref<const Eigen::VectorXd>& parameters) const override {
    return journal_.jacobian_of(derivatives_, parameters);
  }
  bool has_cheap_jacobian() const override { return derivatives_.has_cheap_jacobian(); }

 private:
  const JournalledModel& journal_;
  const DifferentiableModel& derivatives_;
};

}  // namespace mottle::model
