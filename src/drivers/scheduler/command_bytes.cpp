#include "drivers/scheduler/command_bytes.hpp"

namespace mottle::drivers {
namespace {

/// Writes fields, one after another. Members are named in the order of their declaration: a new one does not compile
/// until it is written.
class FieldWriter {
 public:
  explicit FieldWriter(std::string& bytes) : bytes_(bytes) {}
  template <typename... Fields>
  bool all(const Fields&... fields) {
    (one(fields), ...);
    return true;
  }

 private:
  template <typename Value>
  requires(std::is_arithmetic_v<Value> || std::is_enum_v<Value>) void one(const Value& value) {
    append_value(bytes_, value);
  }
  void one(const std::string& text) { append_text(bytes_, text); }
  void one(const std::filesystem::path& path) { append_text(bytes_, path.string()); }
  void one(const std::chrono::milliseconds& time) { one(static_cast<std::int64_t>(time.count())); }
  template <typename Value>
  void one(const std::optional<Value>& value) {
    one(value.has_value());
    if (value) one(*value);
  }
  template <typename Value>
  void one(const std::vector<Value>& values) {
    one(static_cast<std::uint64_t>(values.size()));
    for (const Value& value : values) one(value);
  }
  void one(const std::map<std::string, std::string>& values) {
    one(static_cast<std::uint64_t>(values.size()));
    for (const auto& [name, value] : values) all(name, value);
  }
  template <typename Record>
  void one(const Record& record);

  std::string& bytes_;
};

/// Reads them back.
class FieldReader {
 public:
  explicit FieldReader(ByteReader& reader) : reader_(reader) {}
  template <typename... Fields>
  bool all(Fields&... fields) {
    return (one(fields) && ...);
  }

 private:
  template <typename Value>
  requires(std::is_arithmetic_v<Value> || std::is_enum_v<Value>) bool one(Value& value) { return reader_.read(value); }
  bool one(std::string& text) { return reader_.read_text(text); }
  bool one(std::filesystem::path& path) {
    std::string text;
    const bool is_read = one(text);
    path = text;
    return is_read;
  }
  bool one(std::chrono::milliseconds& time) {
    std::int64_t count = 0;
    const bool is_read = one(count);
    time = std::chrono::milliseconds(count);
    return is_read;
  }
  template <typename Value>
  bool one(std::optional<Value>& value) {
    bool is_there = false;
    if (!one(is_there)) return false;
    value.reset();
    return !is_there || one(value.emplace());
  }
  template <typename Value>
  bool one(std::vector<Value>& values) {
    std::uint64_t size = 0;
    if (!one(size) || size > reader_.left()) return false;
    values.resize(size);
    for (Value& value : values) {
      if (!one(value)) return false;
    }
    return true;
  }
  bool one(std::map<std::string, std::string>& values) {
    std::uint64_t size = 0;
    bool is_read = one(size);
    for (std::uint64_t i = 0; i < size && is_read; ++i) {
      std::string name;
      std::string value;
      is_read = all(name, value);
      values[name] = value;
    }
    return is_read;
  }
  template <typename Record>
  bool one(Record& record);

  ByteReader& reader_;
};

template <typename Fields, typename Record>
bool exchange(Fields& fields, Record& record) {
  using Plain = std::remove_const_t<Record>;
  if constexpr (std::is_same_v<Plain, RunFile>) {
    auto& [source, name, text] = record;
    return fields.all(source, name, text);
  } else if constexpr (std::is_same_v<Plain, CommandLine>) {
    auto& [arguments, is_shell] = record;
    return fields.all(arguments, is_shell);
  } else if constexpr (std::is_same_v<Plain, FrequencyRule>) {
    auto& [file, format, quantity, pattern, after, line, column, modes] = record;
    return fields.all(file, format, quantity, pattern, after, line, column, modes);
  } else if constexpr (std::is_same_v<Plain, ShapeRule>) {
    auto& [file, format, after, line, components] = record;
    return fields.all(file, format, after, line, components);
  } else if constexpr (std::is_same_v<Plain, SchedulerOptions>) {
    auto& [kind, partition, time, account, cores, at_once, licences, per_task, tries, extra] = record;
    return fields.all(kind, partition, time, account, cores, at_once, licences, per_task, tries, extra);
  } else {
    static_assert(std::is_same_v<Plain, SolverCommand>);
    auto& [templates, files, command, retry_command, retries, timeout, parallel, environment, kept, fraction, step,
           frequencies, shapes, scheduler, needs_ranks] = record;
    return fields.all(templates, files, command, retry_command, retries, timeout, parallel, environment, kept, fraction,
                      step, frequencies, shapes, scheduler, needs_ranks);
  }
}

template <typename Record>
void FieldWriter::one(const Record& record) {
  exchange(*this, record);
}

template <typename Record>
bool FieldReader::one(Record& record) {
  return exchange(*this, record);
}

}  // namespace

void append_command(std::string& bytes, const SolverCommand& command) {
  FieldWriter writer(bytes);
  exchange(writer, command);
}

bool read_command(ByteReader& reader, SolverCommand& command) {
  FieldReader fields(reader);
  return exchange(fields, command);
}

}  // namespace mottle::drivers
