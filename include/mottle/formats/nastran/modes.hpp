// Modes in what Nastran prints and punches: the real eigenvalue table and the eigenvectors of .f06 and .pch files.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mottle/formats/text_lines.hpp"
#include "mottle/layers.hpp"

namespace mottle::formats {

/// Shapes at named degrees of freedom.
struct NamedShapes {
  std::vector<std::string> names = {};  ///< "101:+Z", "101:+RX"; of a scalar point its number alone
  Eigen::MatrixXd values = {};          ///< [degree of freedom x mode]
};

/// Puts shapes together from values that come mode by mode, as files list them.
class ShapeCollector {
 public:
  explicit ShapeCollector(std::string file) : file_(std::move(file)) {}

  /// The mode, counted from 1, that the next values belong to: the last one again, the next one, or 1 where all starts
  /// anew. Throws FormatError: any other.
  void begin_mode(int mode, int line);
  void add(std::string name, double value) { modes_.back().push_back({std::move(name), value}); }
  bool is_empty() const { return modes_.empty(); }

  /// Throws FormatError: nothing was added, or a mode lists other degrees of freedom than the first.
  NamedShapes shapes() const;

 private:
  struct Entry {
    std::string name;
    double value;
  };
  std::string file_;
  std::vector<std::vector<Entry>> modes_;
  std::vector<int> lines_;
};

/// Eigenvalues, (rad/s)^2, of the last table "R E A L   E I G E N V A L U E S" of an .f06 file, over all its pages.
///
/// Throws FormatError (file, line): no table, modes that do not count from 1, what is no number.
Eigen::VectorXd read_f06_eigenvalues(LineWalker lines, const std::string& file);

/// The last set of tables "R E A L   E I G E N V E C T O R   N O ." of an .f06 file. Errors as above.
NamedShapes read_f06_shapes(LineWalker lines, const std::string& file);

/// Eigenvalues of the last set of $EIGENVALUE lines of a punch file. Errors as above.
Eigen::VectorXd read_punch_eigenvalues(LineWalker lines, const std::string& file);

/// The last set of blocks $EIGENVECTOR (or $DISPLACEMENTS with a $EIGENVALUE line). Errors as above.
NamedShapes read_punch_shapes(LineWalker lines, const std::string& file);

}  // namespace mottle::formats
