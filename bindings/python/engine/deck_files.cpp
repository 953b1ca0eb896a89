// Files as plain arrays: decks, with other numbers in them, and matrices.
#include <pybind11/eigen.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <memory>

#include "bindings.hpp"
#include "calling_thread.hpp"
#include "mottle/formats/matrices/matrix_file.hpp"
#include "mottle/formats/nastran/rewrite.hpp"
#include "mottle/model/structures/finite_element_structure.hpp"
#include "mottle/mottle.hpp"

namespace mottle::python {
namespace {

namespace py = pybind11;
using Path = std::filesystem::path;
using fem::FiniteElementModel;
using formats::FieldChange;
using formats::NastranModel;
using formats::NastranOptions;
using formats::RewrittenDeck;
using formats::SymmetricMatrix;
using model::FiniteElementStructure;

using Element = std::tuple<std::string, int, std::vector<int>>;

/// Card, id, and ids of the nodes of each element; 0: ground, or a node that is left out.
std::vector<Element> elements_of(const FiniteElementModel& model) {
  std::vector<Element> elements;
  fem::for_each_list(model.element_lists, [&](const auto& list) {
    const auto& traits = fem::traits_of(list);
    for (const auto& element : list) {
      std::vector<int> ids;
      for (const int node : traits.nodes(element)) {
        ids.push_back(node < 0 ? 0 : model.nodes[static_cast<std::size_t>(node)].id);
      }
      elements.emplace_back(traits.card(element), element.id, std::move(ids));
    }
  });
  return elements;
}

py::tuple nodes_of(const FiniteElementModel& model) {
  const auto count = static_cast<Eigen::Index>(model.nodes.size());
  std::vector<int> ids;
  Eigen::MatrixX3d positions(count, 3);
  for (Eigen::Index k = 0; k < count; ++k) {
    const fem::Node& node = model.nodes[static_cast<std::size_t>(k)];
    ids.push_back(node.id);
    positions.row(k) = node.position.transpose();
    if (node.is_scalar) positions.row(k).setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  return py::make_tuple(ids, positions);
}

std::vector<std::pair<std::string, double>> numbers_of(const FiniteElementModel& model) {
  std::vector<std::pair<std::string, double>> numbers;
  for (const fem::CardField& field : model.fields) {
    numbers.emplace_back(fmt::format("{}:{}:{}", field.card, field.id, field.name), field.value);
  }
  return numbers;
}

py::tuple matrices_of(const std::shared_ptr<const NastranModel>& deck) {
  struct Assembled {
    SparseMatrix stiffness, mass;
    std::vector<std::string> names;
  };
  Assembled found = CallingThread::run_by_itself([deck](const auto* /*stop*/) {
    const Eigen::VectorXd none;
    const FiniteElementStructure structure(deck->model, {}, none);
    const FiniteElementStructure::Matrices matrices = structure.matrices_at(none);
    std::vector<std::string> names;
    for (int row = 0; row < matrices.stiffness.rows(); ++row) names.push_back(structure.equation_name(row));
    return Assembled{matrices.stiffness, matrices.mass, std::move(names)};
  });
  return py::make_tuple(std::move(found.stiffness), std::move(found.mass), std::move(found.names));
}

void add_deck_arrays(py::module_& module) {
  py::class_<NastranModel, std::shared_ptr<NastranModel>> deck(module, "Deck");
  deck.def_property_readonly("notes", [](const NastranModel& self) { return self.notes; });
  deck.def_property_readonly("files", [](const NastranModel& self) { return self.files; });
  deck.def("nodes", [](const NastranModel& self) { return nodes_of(self.model); });
  deck.def("elements", [](const NastranModel& self) { return elements_of(self.model); });
  deck.def("numbers", [](const NastranModel& self) { return numbers_of(self.model); });
  deck.def("matrices", [](const std::shared_ptr<NastranModel>& self) { return matrices_of(self); });
  module.def(
      "read_deck",
      [](const Path& file, const std::set<std::string>& ignored, std::optional<int> subcase) {
        return CallingThread::run_by_itself([=](const auto* /*stop*/) {
          return std::make_shared<NastranModel>(formats::read_nastran_model(file, {ignored, subcase}));
        });
      },
      py::arg("file"), py::kw_only(), py::arg("ignore_cards"), py::arg("subcase"));
  module.def(
      "rewrite_deck",
      [](const Path& file, const std::set<std::string>& ignored, std::optional<int> subcase,
         const std::vector<std::tuple<std::string, int, std::string, double>>& numbers) {
        std::vector<FieldChange> changes;
        for (const auto& [card, id, name, value] : numbers) changes.push_back({card, id, name, value});
        const RewrittenDeck rewritten = CallingThread::run_by_itself([=](const auto* /*stop*/) {
          return formats::rewrite_nastran_deck(file, {ignored, subcase}, changes);
        });
        std::vector<std::pair<std::string, py::bytes>> files;
        for (const formats::RewrittenFile& each : rewritten.files) files.emplace_back(each.name, each.bytes);
        return py::make_tuple(files, rewritten.rounding);
      },
      py::arg("file"), py::kw_only(), py::arg("ignore_cards"), py::arg("subcase"), py::arg("numbers"));
}

}  // namespace

void add_deck_files(py::module_& module) {
  add_deck_arrays(module);
  module.def(
      "read_matrix",
      [](const std::string& location) {
        SymmetricMatrix matrix = CallingThread::run_by_itself(
            [location](const auto* /*stop*/) { return formats::read_symmetric_matrix(location); });
        return py::make_tuple(std::move(matrix.lower), matrix.names, matrix.fixed_rows);
      },
      py::arg("location"));
}

}  // namespace mottle::python
