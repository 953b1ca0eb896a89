// Runs a fuzz target over kept inputs and over changes of them that are the same in every run: what a search (`make
// fuzz`) has found stays found, without a fuzzer.   REPLAY CHANGES FILE-OR-FOLDER...
#include <sanitizer/common_interface_defs.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

/// As libFuzzer has it: libraries may ask for what a file says, and go on where they do not get it.
extern "C" __attribute__((weak)) const char* __asan_default_options() {  // NOLINT(bugprone-reserved-identifier)
  return "allocator_may_return_null=1";
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

constexpr std::size_t k_largest = 1 << 16;  // of an input; a search makes none above 4096 bytes
// What runs now; never destroyed, since leaks are reported after the end.
std::string& running_name = *new std::string;
std::string& running = *new std::string;

/// Says which input has ended the program, and keeps it.
void report_input() {
  std::fprintf(stderr, "the input is %s (%zu bytes), kept as fuzz-finding\n", running_name.c_str(), running.size());
  std::ofstream("fuzz-finding", std::ios::binary) << running;
}

void run(const std::string& name, const std::string& bytes) {
  running_name = name;
  running = bytes;
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(running.data()), running.size());
}

std::vector<std::filesystem::path> files_of(int count, char** arguments) {
  std::vector<std::filesystem::path> files;
  for (int i = 0; i < count; ++i) {
    if (!std::filesystem::is_directory(arguments[i])) {
      files.emplace_back(arguments[i]);
      continue;
    }
    for (const auto& entry : std::filesystem::directory_iterator(arguments[i])) {
      if (entry.is_regular_file()) files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// One to four edits: a bit turned, a byte replaced, a piece cut out, repeated, or taken from elsewhere in the file.
std::string changed(std::string bytes, std::mt19937_64& random) {
  const auto below = [&](std::size_t limit) {
    return static_cast<std::size_t>(random() % std::max<std::size_t>(limit, 1));
  };
  constexpr std::string_view k_telling = "\0 \n\t,=+-*/$[]{}\"019eE.\xff";
  for (std::size_t edits = 1 + below(4); edits > 0 && !bytes.empty(); --edits) {
    const std::size_t at = below(bytes.size());
    const std::string piece = bytes.substr(below(bytes.size()), 1 + below(64));
    switch (below(6)) {
      case 0:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        break;
      case 1:
        bytes[at] = k_telling[below(k_telling.size())];
        break;
      case 2:
        bytes.erase(at, 1 + below(16));
        break;
      case 3:
        bytes.insert(at, piece);
        break;
      case 4:
        bytes.replace(at, std::min(piece.size(), bytes.size() - at), piece);
        break;
      default:
        bytes.resize(at);
        break;
    }
  }
  bytes.resize(std::min(bytes.size(), k_largest));
  return bytes;
}

struct Input {
  std::string name;
  std::string bytes;
};

/// The file itself; of a file *.hex, in which a search has kept inputs, that of each line.
std::vector<Input> inputs_of(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  std::ifstream stream(file, std::ios::binary);
  if (file.extension() != ".hex") {
    Input whole{name, {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()}};
    whole.bytes.resize(std::min(whole.bytes.size(), k_largest));
    return {whole};
  }
  std::vector<Input> inputs;
  for (std::string line; std::getline(stream, line);) {
    Input& input = inputs.emplace_back(Input{name + ", line " + std::to_string(inputs.size() + 1), {}});
    for (std::size_t at = 0; at + 1 < line.size(); at += 2) {
      input.bytes += static_cast<char>(std::stoi(line.substr(at, 2), nullptr, 16));
    }
  }
  return inputs;
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 3) return 2;
  __sanitizer_set_death_callback(report_input);
  std::signal(SIGABRT, [](int) { report_input(); });
  const long changes = std::strtol(arguments[1], nullptr, 10);
  long kept = 0;
  long runs = 0;
  for (const auto& file : files_of(count - 2, arguments + 2)) {
    for (const auto& [name, bytes] : inputs_of(file)) {
      run(name, bytes);
      ++kept;
      std::mt19937_64 random(std::hash<std::string>{}(name));
      for (long i = 0; i < changes; ++i, ++runs) run(name + ", change " + std::to_string(i), changed(bytes, random));
    }
  }
  std::printf("%ld kept inputs and %ld changes of them, no finding\n", kept, runs);
  return kept == 0 ? 2 : 0;
}
