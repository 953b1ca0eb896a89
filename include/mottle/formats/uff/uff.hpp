// Universal files (.uff, .unv): bytes <-> plain data, numbers as they stand in the file. What the data mean in SI units
// and in the global frame is formats/uff_frames.
#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mottle/fem/finite_element_model.hpp"
#include "mottle/layers.hpp"

namespace mottle::formats {

/// Five lines of text in front of shapes and functions.
using UffTitles = std::array<std::string, 5>;

/// Dataset 151: model file, description, program, created, saved, program that wrote the file, written.
struct UffHeader {
  std::array<std::string, 7> lines = {};
};

/// Dataset 164: a number of the file divided by the factor of its unit is in SI.
struct UffUnits {
  int code = 1;
  std::string description = {};
  int temperature_mode = 2;
  double length = 1.0, force = 1.0, temperature = 1.0, temperature_offset = 0.0;
};

/// Datasets 15 and 2411. Dataset 15 gives the position in the definition system, 2411 in the global one.
struct UffNode {
  int id = 0;
  int definition_system = 0;
  int displacement_system = 0;
  int color = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  bool is_local = false;  ///< the position is in the definition system
  int line = 0;           ///< where it stands in the file, as below
};

/// Dataset 82: a line through nodes, 0 lifts the pen.
struct UffTraceLine {
  int id = 0;
  int color = 0;
  std::string name = {};
  std::vector<int> nodes = {};
};

/// Dataset 2412.
struct UffElement {
  int id = 0;
  int descriptor = 0;  ///< 11, 21...24: lines; 41, 44, 91, 94: shells; 111...: solids
  int physical_property = 0, material_property = 0;
  int color = 0;
  std::array<int, 3> beam = {};  ///< orientation node and end cross-sections, of lines
  std::vector<int> nodes = {};
};

/// Datasets 18 and 2420.
struct UffCoordinateSystem {
  CoordinateSystem system = {};  ///< within `reference`
  int reference = 0;             ///< 0: global
  int color = 0;
  std::string name = {};
  int line = 0;
};

/// Datasets 55 and 2414, of normal modes and complex eigenvalues at nodes.
struct UffShape {
  UffTitles titles = {};
  int model_type = 1;
  int analysis_type = 2;  ///< 2: normal mode; 3, 7: complex eigenvalue of first, second order
  int quantity = 8;       ///< specific data type: 8 displacement, 11 velocity, 12 acceleration
  bool is_complex = false;
  int load_case = 0;
  int mode = 0;
  double frequency = 0.0;   ///< Hz, of a normal mode
  double modal_mass = 0.0;  ///< of a normal mode; 0: not given
  double viscous_damping = 0.0, hysteretic_damping = 0.0;
  std::complex<double> eigenvalue = {};             ///< rad/s, of a complex mode
  std::complex<double> modal_a = {}, modal_b = {};  ///< 0: not given
  std::vector<int> nodes = {};
  Eigen::MatrixXcd values = {};  ///< [node x 3 or 6], in the nodes' displacement systems
  int line = 0;
};

/// One axis of a function.
struct UffAxis {
  int quantity = 0;               ///< specific data type: 17 time, 18 frequency, 8 displacement, 13 force...
  std::array<int, 3> units = {};  ///< exponents of length, force, temperature; hold for quantity 1 (general) alone
  std::string label = {};
  std::string unit = {};
};

/// Datasets 58 and 58b.
struct UffFunction {
  UffTitles titles = {};
  int type = 0;  ///< 1 time response, 2 auto-spectrum, 3 cross-spectrum, 4 frequency response, 6 coherence...
  int id = 0, version = 0, load_case = 0;
  std::string response_name = "NONE", reference_name = "NONE";
  int response_node = 0, response_direction = 0;  ///< direction: +-1...3 translations, +-4...6 rotations
  int reference_node = 0, reference_direction = 0;
  bool is_complex = false, is_double = true, is_even = true, is_binary = false;
  double start = 0.0, step = 0.0, z = 0.0;
  UffAxis abscissa_axis = {}, ordinate_axis = {}, denominator_axis = {}, z_axis = {};
  Eigen::VectorXd abscissa = {};
  Eigen::VectorXcd values = {};
  int line = 0;
};

/// What a universal file holds, in its order.
struct UffFile {
  std::string file = {};  ///< for messages
  std::optional<UffHeader> header = std::nullopt;
  std::optional<UffUnits> units = std::nullopt;
  std::vector<UffCoordinateSystem> systems = {};
  std::vector<UffNode> nodes = {};
  std::vector<UffTraceLine> trace_lines = {};
  std::vector<UffElement> elements = {};
  std::vector<UffShape> shapes = {};
  std::vector<UffFunction> functions = {};
  std::vector<std::string> notes = {};  ///< datasets that were left out, and why
};

/// Reads datasets 15, 18, 55, 58, 58b, 82, 151, 164, 2411, 2412, 2414, 2420; others are left out. Fields may be
/// separated by blanks or stand in their columns; D exponents, lower case, CRLF, any bytes in texts and short lines are
/// allowed.
///
/// @param bytes  the file's content
/// @param file   its name, for messages
/// @throws FormatError  with the line (and within 58b the byte): no dataset, text where a number should be, too few or
/// too many
///                      numbers, a dataset that is not ended, units that contradict each other, a node or coordinate
///                      system given twice with other content, a binary function in no IEEE format
UffFile parse_uff(std::string_view bytes, const std::string& file);

/// Which of the datasets that hold the same are written.
struct UffWriteOptions {
  int nodes = 2411;            ///< or 15, six digits
  int shapes = 55;             ///< or 2414
  bool is_big_endian = false;  ///< byte order of binary functions
};

/// Writes header, units, nodes, trace lines, elements, shapes and functions; coordinate systems as 2420.
///
/// What is read again is what the format's digits hold: positions of 2411, axes, factors of 164, values of 58b and of a
/// double-precision 58 to 17, 17, 18, all and 12 digits; positions of 15, shapes and a single-precision 58 to 6 digits.
/// Titles are cut at 80 bytes.
std::string format_uff(const UffFile& contents, const UffWriteOptions& options = {});

}  // namespace mottle::formats
