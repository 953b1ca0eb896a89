#include "study/tests/pair_tests.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/subject.hpp"
#include "mottle/dynamics/modes/mac.hpp"
#include "study/input/first_few.hpp"

namespace mottle::study {

std::vector<std::string> pair_tests(Eigen::MatrixXd& values, const OutputSelection& selection,
                                    const Eigen::Ref<const Eigen::MatrixXd>& reference) {
  const std::vector<int>& modes = selection.shape_modes;
  const Subject pairing{Subject::Kind::pairing};
  require_of(!modes.empty(), pairing,
             "it needs measured shapes; name them in outputs.shapes, or give pairing = \"order\"");
  require_of(selection.frequencies.empty() || selection.frequencies == modes, pairing,
             "outputs.frequencies and outputs.shapes.modes must name the same modes in the same order");
  const auto count = static_cast<Eigen::Index>(modes.size());
  const Eigen::Index points = reference.rows();
  const auto first_shape = static_cast<Eigen::Index>(selection.frequencies.size());
  const double not_measured = std::numeric_limits<double>::quiet_NaN();
  const Eigen::Index first_damping = first_shape + count * points;
  const auto damping_column = [&](int mode) -> Eigen::Index {  // -1: it is no output
    const auto found = std::ranges::find(selection.damping, mode);
    return found == selection.damping.end() ? -1 : first_damping + std::distance(selection.damping.begin(), found);
  };
  std::vector<std::string> moved;
  std::vector<std::string> doubtful;
  for (Eigen::Index s = 0; s < values.rows(); ++s) {
    const Eigen::RowVectorXd row = values.row(s);
    Eigen::MatrixXd shapes = row.segment(first_shape, count * points).reshaped(points, count);
    for (Eigen::Index t = 0; t < count; ++t) {
      if (!shapes.col(t).allFinite()) shapes.col(t).setZero();
    }
    const Eigen::MatrixXd cosines = shape_cosines(reference, shapes);
    const std::vector<int> test_of = optimal_assignment(cosines.cwiseAbs2());
    for (Eigen::Index m = 0; m < count; ++m) {
      const Eigen::Index t = test_of[static_cast<std::size_t>(m)];
      const double mac = cosines(m, t) * cosines(m, t);
      const bool is_paired = mac >= selection.minimum_mac && mac > 0.0;
      const double sign = cosines(m, t) < 0.0 ? -1.0 : 1.0;
      const int number = modes[static_cast<std::size_t>(m)];
      if (first_shape > 0) values(s, m) = is_paired ? row(t) : not_measured;
      for (Eigen::Index d = 0; d < points; ++d) {
        values(s, first_shape + m * points + d) = is_paired ? sign * shapes(d, t) : not_measured;
      }
      const int label = modes[static_cast<std::size_t>(t)];
      if (const Eigen::Index zeta = damping_column(number); zeta >= 0) {
        const Eigen::Index measured = damping_column(label);
        values(s, zeta) = is_paired && measured >= 0 ? row(measured) : not_measured;
      }
      if (is_paired && t != m) {
        moved.push_back(fmt::format("specimen {} mode {} is the model's {} (MAC {:.2f})", s + 1, label, number, mac));
      } else if (!is_paired && !shapes.col(t).isZero(0.0)) {
        doubtful.push_back(
            fmt::format("specimen {} mode {} (best MAC with mode {}: {:.2f})", s + 1, label, number, mac));
      }
    }
  }
  std::vector<std::string> notes;
  if (!moved.empty())
    notes.push_back(fmt::format("Paired by shape, {} modes renumbered: {}.", moved.size(), first_few(moved)));
  if (!doubtful.empty()) {
    notes.push_back(fmt::format("Modes that fit none of the model's and are left out: {}.", first_few(doubtful)));
  }
  return notes;
}

std::string turn_shapes(Eigen::MatrixXd& values, const OutputSelection& selection,
                        const Eigen::Ref<const Eigen::MatrixXd>& reference) {
  const Eigen::Index points = reference.rows();
  const double limit = -std::sqrt(selection.minimum_mac);
  std::vector<std::string> turned;
  for (Eigen::Index s = 0; s < values.rows(); ++s) {
    for (Eigen::Index m = 0; m < reference.cols(); ++m) {
      auto shape = values.row(s).segment(static_cast<Eigen::Index>(selection.frequencies.size()) + m * points, points);
      std::vector<Eigen::Index> rows;  // measured
      for (Eigen::Index d = 0; d < points; ++d) {
        if (!std::isnan(shape(d))) rows.push_back(d);
      }
      const Eigen::VectorXd measured = shape(rows).transpose();
      if (rows.size() < 2) continue;
      const double cosine = shape_cosines(reference.col(m)(rows), measured)(0, 0);  // 0 of a zero shape
      if (cosine > limit || cosine == 0.0) continue;
      shape = -shape.eval();
      turned.push_back(fmt::format("specimen {} mode {}", s + 1, selection.shape_modes[static_cast<std::size_t>(m)]));
    }
  }
  if (turned.empty()) return {};
  return fmt::format("Shapes that were upside down against the model's and are turned, {}: {}.", turned.size(),
                     first_few(turned));
}

}  // namespace mottle::study
