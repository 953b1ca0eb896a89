// Traits of a kind of element (matrices, topology, quality, cards). Each kind has one set of traits, made in its own
// source; assembly, `check`, drawings, files for ParaView and names of parameters use them and know no kind by name.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::fem {

struct FiniteElementModel;
struct ElementPieces;
enum class PieceSelection : std::uint8_t;

/// Cells of VTK, by its numbers.
enum class VtkCell : std::uint8_t {
  none = 0,
  line = 3,
  triangle = 5,
  quadrilateral = 9,
  tetrahedron = 10,
  hexahedron = 12,
  wedge = 13,
  pyramid = 14,
  quadratic_triangle = 22,
  quadratic_quadrilateral = 23,
  quadratic_tetrahedron = 24,
  quadratic_hexahedron = 25,
  quadratic_wedge = 26,
  quadratic_pyramid = 27,
};

/// How an element is drawn. The numbers count the element's own nodes from 0.
struct Topology {
  VtkCell cell = VtkCell::none;
  std::vector<int> cell_nodes = {};            ///< in VTK's order
  std::vector<std::vector<int>> faces = {};    ///< the 3 or 4 corners of each, in order around it
  std::vector<std::array<int, 2>> lines = {};  ///< the two ends of each that is drawn besides the edges of faces
  std::vector<int> points = {};                ///< nodes that are drawn as points
  bool is_solid = false;                       ///< a face that it shares with another solid lies inside
};

/// Quality measures of an element's form.
struct ElementQuality {
  double jacobian_ratio = 1.0;
  double aspect_ratio = 1.0;
  std::optional<double> warp = std::nullopt;  ///< of kinds that can be warped
};

/// Numbers of an element's position or orientation that a parameter may move: "CBAR:3:X1".
template <typename Element>
struct GeometryNumbers {
  std::vector<std::string> cards = {};  ///< cards of this kind of element that have them
  std::vector<std::string> names = {};
  double& (*at)(Element&, int number) = nullptr;  ///< in the order of the names
};

template <typename Element>
struct ElementTraits {
  std::string_view (*card)(const Element&) = nullptr;       ///< "CHEXA", for messages
  const char* counted_as = nullptr;                         ///< name of all in the counts; without it each by its card
  std::span<const int> (*nodes)(const Element&) = nullptr;  ///< indices into the model's nodes; -1: ground or left out
  const Topology& (*topology)(const Element&) = nullptr;
  /// Adds degrees of freedom and matrices. @throws InvalidInput  a form or section that cannot be
  void (*add_pieces)(const FiniteElementModel&, const Element&, PieceSelection, ElementPieces&) = nullptr;
  const char* family = nullptr;                                                    ///< "solids", with `quality`
  ElementQuality (*quality)(const FiniteElementModel&, const Element&) = nullptr;  ///< none: it has no form
  GeometryNumbers<Element> geometry = {};
};

}  // namespace mottle::fem
