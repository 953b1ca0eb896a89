// libFuzzer target for what comes over the network: whatever the bytes, a server's answer is read as the protocol says
// or refused with AnswerFault, and a client's request is answered with JSON or gives a computation of the right sizes.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string_view>

#include "drivers/umbridge/model_requests.hpp"
#include "drivers/umbridge/protocol.hpp"
#include "mottle/drivers/umbridge/http_address.hpp"

namespace {

namespace drivers = mottle::drivers;

void expect(bool claim) {
  if (!claim) std::abort();
}

template <typename Error, typename Read>
void attempt(const Read& read) {
  try {
    read();
  } catch (const Error&) {
    return;
  }
}

void read_as_answer(std::string_view bytes, int status) {
  using drivers::AnswerFault;
  attempt<AnswerFault>([&] { drivers::read_info(status, bytes); });
  attempt<AnswerFault>([&] { drivers::read_features(status, bytes); });
  attempt<AnswerFault>([&] {
    std::size_t sum = 0;
    for (const std::size_t size : drivers::read_sizes(status, bytes, "inputSizes")) sum += size;
    expect(sum <= 1'000'000);
  });
  attempt<AnswerFault>([&] {
    const drivers::Vectors found = drivers::read_output(status, bytes, {2, 1});
    expect(status == 200 && found.size() == 2 && found[0].size() == 2 && found[1].size() == 1);
    expect(std::isfinite(found[0][0]) && std::isfinite(found[0][1]) && std::isfinite(found[1][0]));
  });
  attempt<AnswerFault>([&] { expect(drivers::read_vector(status, bytes, 3).size() == 3); });
}

void read_as_request(std::string_view bytes) {
  static const drivers::ServedModel k_model{
      .inputs = 2, .outputs = 3, .jacobian = [](const Eigen::VectorXd&) { return Eigen::MatrixXd(3, 2); }};
  for (const char* path :
       {"/Info", "/ModelInfo", "/InputSizes", "/Evaluate", "/Gradient", "/ApplyJacobian", "/ApplyHessian"}) {
    const drivers::ReadRequest read = drivers::read_request(k_model, true, path, bytes);
    if (read.answer) {
      expect(nlohmann::json::parse(read.answer->body).is_object());
      continue;
    }
    expect(read.computation.x.size() == 2 && read.computation.x.allFinite() && read.computation.vector.allFinite());
    const Eigen::Index sizes[] = {0, 3, 2};
    expect(read.computation.vector.size() == sizes[static_cast<int>(read.computation.kind)]);
  }
  expect(drivers::read_request(k_model, true, bytes, "{}").answer.has_value());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  read_as_answer(bytes, 200);
  read_as_answer(bytes, 500);
  read_as_request(bytes);
  attempt<mottle::InvalidInput>([&] {
    const drivers::HttpAddress address = drivers::parse_http_address(std::string(bytes));
    expect(address.text().find_first_of("\r\n ") == std::string::npos);
  });
  return 0;
}
