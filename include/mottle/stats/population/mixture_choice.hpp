// How many batches a population has: mixtures of several numbers of components, found from many starts and compared by
// a bootstrap of the likelihood ratio; what of two batches can be told from one.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "mottle/core/run_context.hpp"
#include "mottle/layers.hpp"
#include "mottle/stats/population/normal_mixture.hpp"

namespace mottle::stats {

/// How mixtures are searched for and compared.
struct MixtureSearch {
  MixtureSettings settings = {};  ///< its outliers are found anew for each set of units
  double outlier_fraction = 0.01;
  double outlier_width = 3.0;
  int starts = 8;       ///< at random, beside those that split a component of the fit with one less
  int samples = 199;    ///< of the bootstrap
  double level = 0.05;  ///< of each test
  int most = 5;         ///< components

  /// The settings with the outliers' population of these units.
  MixtureSettings settings_for(const MixtureData& data) const;
};

/// Smallest number of units in which that many components can be looked for: three a component, and a scatter about
/// their means that is regular.
///
/// @param together  effects that may be correlated with one another, at most
int fewest_units(int components, Eigen::Index together);

/// The best of the local maxima that starts lead to: splits of the components of `fewer` at a value of a direction
/// [Engelman1969], the best four of many, and parts of the units that are nearest to one of as many drawn units as
/// there are components. Units far from the others of their part take no part in a start.
///
/// @param fewer  a fit with one component less, or null
/// @param key    names the random starts
/// @return       nothing where no start leads to components of three units
std::optional<MixtureFit> find_mixture(const MixtureData& data, int components, const MixtureFit* fewer,
                                       const MixtureSettings& settings, int starts, const StreamKey& key);

/// Likelihood ratio of one component more.
struct ComponentsTest {
  int components = 1;      ///< of the null hypothesis; the alternative has one more
  double statistic = 0.0;  ///< 2 (l_K+1 - l_K)
  double critical = 0.0;   ///< larger in the share `level` of the samples; nan: too few were needed to say
  double p_value = 1.0;
  int samples = 0;  ///< that were needed
  bool is_refused = false;
};

struct MixtureChoice {
  MixtureFit fit;
  std::vector<ComponentsTest> tests;
};

/// The number of components by tests of 1 against 2, 2 against 3, and so on until one does not refuse:
///
///   T = 2 (l_K+1 - l_K),   p = (1 + number of T* >= T) / (1 + samples),
///
/// T* of units drawn from the fit with K components, with the same designs and noise, searched as the data are. One
/// batch is split with the probability `level`, whatever of the starts is missed, as long as its parameters do not
/// matter to T's law. After the first test samples end when their verdict is certain [Besag1991].
///
/// @throws Stopped
/// Source: [McLachlan1987].
MixtureChoice choose_mixture(const MixtureData& data, const MixtureSearch& search, const RunContext& context);

/// Distance between the means of two batches of equal size, in standard deviations of a batch with its noise, that the
/// first test finds with a probability of 80 %: by bisection over samples of the same designs whose random numbers do
/// not change with the distance. Each is fitted from its true batches and from the best split.
///
/// @param within    scatter of a batch
/// @param critical  of the first test
/// @param samples   at each distance
/// @return          nothing where 20 standard deviations are not found
std::optional<double> detectable_distance(const MixtureData& data, const Eigen::MatrixXd& within, double critical,
                                          const MixtureSearch& search, int samples, const RunContext& context);

/// Units of the same designs, drawn from a mixture and its outliers.
MixtureData draw_units(const MixtureData& like, const std::vector<MixtureComponent>& components,
                       const OutlierPopulation& outliers, const StreamKey& key);

/// Fits to units drawn from a fit, each from the true components, so that they keep their order; those that lose a
/// component are left out.
std::vector<MixtureFit> redrawn_fits(const MixtureData& data, const MixtureFit& fit, const MixtureSearch& search,
                                     const RunContext& context);

}  // namespace mottle::stats
