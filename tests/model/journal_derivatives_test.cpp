// Derivatives in a journal, between evaluations, asked for in any order and cut off anywhere.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "core/temporary_folder.hpp"
#include "mottle/core/files.hpp"
#include "mottle/model/journal.hpp"

namespace mottle::model {
namespace {

/// y = (x1 + x2, x1 x2) and its derivatives; counts what it is asked.
class Product final : public Model, public DifferentiableModel {
 public:
  Eigen::Index parameter_count() const override { return 2; }
  const std::vector<Quantity>& outputs() const override { return outputs_; }
  Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext&) const override {
    evaluated += static_cast<int>(samples.rows());
    Evaluation result;
    result.outputs.resize(samples.rows(), 2);
    result.outputs << samples.rowwise().sum(), samples.rowwise().prod();
    return result;
  }
  Eigen::MatrixXd jacobian(const Eigen::Ref<const Eigen::VectorXd>& x) const override {
    ++differentiated;
    return Eigen::Matrix2d{{1.0, 1.0}, {x(1), x(0)}};
  }
  mutable int evaluated = 0;
  mutable int differentiated = 0;

 private:
  std::vector<Quantity> outputs_{named_quantity("sum", "-"), named_quantity("product", "-")};
};

const std::vector<Eigen::Vector2d> k_points{{1.0, 2.0}, {3.0, 4.0}, {5.0, 6.0}};

/// Batch, derivatives at the three points, in an order, another batch.
Eigen::MatrixXd course(const Product& model, const std::filesystem::path& path, bool resume,
                       const std::vector<std::size_t>& order) {
  const JournalledModel journal(model, path, Digest{1, 2}, resume);
  const JournalledDerivatives derivatives(journal, model);
  Eigen::MatrixXd found(6, 4);
  found.block(0, 0, 3, 2) = journal.evaluate(Eigen::MatrixXd::Constant(3, 2, 2.0), {}).outputs;
  for (const std::size_t k : order) {
    found.block(2 * static_cast<Eigen::Index>(k), 2, 2, 2) = derivatives.jacobian(k_points[k]);
  }
  found.block(3, 0, 3, 2) = journal.evaluate(Eigen::MatrixXd::Constant(3, 2, 7.0), {}).outputs;
  return found;
}

TEST(JournalledDerivatives, AreNotComputedAgainInWhateverOrderTheyAreAskedFor) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder / "journal";
  const Eigen::MatrixXd wanted = course(Product(), path, false, {0, 1, 2});
  const Product model;
  EXPECT_EQ(course(model, path, true, {2, 0, 1}), wanted);
  EXPECT_EQ(model.evaluated, 0);
  EXPECT_EQ(model.differentiated, 0);
}

TEST(JournalledDerivatives, OnlyWhatAKillCutOffIsComputedAgain) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder / "journal";
  const Eigen::MatrixXd wanted = course(Product(), path, false, {0, 1, 2});
  const std::string whole = read_file(path);
  int computed_before = 9;
  for (std::size_t length = 0; length <= whole.size(); ++length) {
    write_file_atomically(path, whole.substr(0, length));
    const Product model;
    ASSERT_EQ(course(model, path, true, {1, 2, 0}), wanted) << length;
    const int computed = model.evaluated + model.differentiated;
    ASSERT_LE(computed, computed_before) << length;
    computed_before = computed;
    const Product again;  // what was computed again is kept behind what was there
    ASSERT_EQ(course(again, path, true, {0, 1, 2}), wanted) << length;
    ASSERT_EQ(again.evaluated + again.differentiated, 0) << length;
  }
  EXPECT_EQ(computed_before, 0);
}

TEST(JournalledDerivatives, GoToTheModelWithoutAJournal) {
  const Product model;
  course(model, {}, false, {0, 1, 2});
  course(model, {}, true, {0, 1, 2});
  EXPECT_EQ(model.differentiated, 6);
}

}  // namespace
}  // namespace mottle::model
