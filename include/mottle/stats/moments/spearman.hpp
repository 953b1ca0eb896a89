// Spearman's rank correlation: how monotone an output is in an input, whatever the shape of the curve.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"

namespace mottle::stats {

/// Rank correlation of every column of `inputs` with every column of `outputs`: Pearson's correlation of the ranks,
/// equal values sharing the average of their ranks.
///
/// @param inputs   [sample x input], at least 2 rows, no nan
/// @param outputs  [sample x output], the same rows
/// @return         [input x output], in [-1, 1]; 0 where either column is constant
/// @throws InvalidInput  row counts differ, fewer than 2 rows, or an entry is nan
/// Source: [Spearman1904]; [Mares2006], Fig. 3.
Eigen::MatrixXd spearman(const Eigen::Ref<const Eigen::MatrixXd>& inputs,
                         const Eigen::Ref<const Eigen::MatrixXd>& outputs);

/// Ranks from 1 to n, equal values sharing the average of their ranks.
///
/// @param values  [sample], no nan
Eigen::VectorXd average_ranks(const Eigen::Ref<const Eigen::VectorXd>& values);

}  // namespace mottle::stats
