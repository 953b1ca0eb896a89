#include "mottle/drivers/scheduler/array_folder.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <random>
#include <sstream>

#include "drivers/scheduler/command_bytes.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/drivers/command/run_folders.hpp"

namespace mottle::drivers {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view k_magic = "mottle array 2\n";
constexpr const char* k_array = "array";
constexpr const char* k_array_mark = ".mottle-array";  // only what holds it is ever removed
constexpr const char* k_job = "job";

/// One word of a shell, whatever is in it.
std::string quoted(const std::string& text) {
  std::string safe = "'";
  for (const char c : text) safe += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return safe + "'";
}

std::string script_text(const fs::path& folder, const std::string& number_variable) {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error) throw SystemFailure(fmt::format("Mottle's own program is not found: {}", error.message()));
  return fmt::format(
      "#!/bin/sh\n"
      "# A task of Mottle's: some runs of a solver. Written and submitted by Mottle.\n"
      "n=${{{}:-1}}\n"
      "cd {} || exit 1\n"
      "export MOTTLE_RANKS=off\n"
      "exec {} run-task {} \"$n\" >>\"task-$n/output.txt\" 2>&1\n",
      number_variable, quoted(folder.string()), quoted(program.string()), quoted(folder.string()));
}

std::uint64_t inode_of(const fs::path& folder) {
  struct stat status {};
  return ::stat(folder.c_str(), &status) == 0 ? static_cast<std::uint64_t>(status.st_ino) : 0;
}

std::string head_of(const ArrayPlan& plan, std::uint64_t inode) {
  std::string head;
  append_text(head, plan.name);
  append_value(head, inode);
  append_command(head, plan.command);
  append_value(head, static_cast<std::uint64_t>(plan.parameters.size()));
  for (const std::string& name : plan.parameters) append_text(head, name);
  append_value(head, plan.min_modes);
  append_value(head, plan.constants);
  append_value(head, static_cast<std::uint64_t>(plan.keys.size()));
  return head;
}

/// The bytes of values that lie one behind the other.
std::string_view bytes_of(const void* values, std::size_t size) {
  return {static_cast<const char*>(values), size};
}

/// Written from where it lies: a copy of hundreds of thousands of runs would be the most that a Mottle needs.
void write_plan(const fs::path& file, const ArrayPlan& plan, std::uint64_t inode) {
  const std::string head = head_of(plan, inode);
  const auto tasks = static_cast<std::uint64_t>(plan.ends.size());
  const std::array body{std::string_view(head), bytes_of(plan.keys.data(), plan.keys.size() * sizeof(Digest)),
                        bytes_of(plan.values.data(), static_cast<std::size_t>(plan.values.size()) * sizeof(double)),
                        bytes_of(&tasks, sizeof(tasks)),
                        bytes_of(plan.ends.data(), plan.ends.size() * sizeof(std::size_t))};
  Checksum sum;
  for (const std::string_view piece : body) sum.add(piece);
  const Digest digest = sum.digest();
  std::vector<std::string_view> pieces{k_magic, bytes_of(digest.data(), sizeof(digest))};
  pieces.insert(pieces.end(), body.begin(), body.end());
  write_file_atomically(file, pieces);
}

bool read_runs(ByteReader& reader, ArrayPlan& plan) {
  std::uint64_t runs = 0;
  std::uint64_t tasks = 0;
  if (!reader.read(runs) || runs > reader.left()) return false;
  plan.keys.resize(runs);
  plan.values.resize(static_cast<Eigen::Index>(runs), static_cast<Eigen::Index>(plan.parameters.size()));
  if (!reader.copy(plan.keys.data(), runs * sizeof(Digest)) ||
      !reader.copy(plan.values.data(), static_cast<std::size_t>(plan.values.size()) * sizeof(double)) ||
      !reader.read(tasks) || tasks > reader.left()) {
    return false;
  }
  plan.ends.resize(tasks);
  return reader.copy(plan.ends.data(), tasks * sizeof(std::size_t)) && std::ranges::is_sorted(plan.ends) &&
         (tasks == 0 || plan.ends.back() == runs);
}

bool read_plan(ByteReader reader, ArrayPlan& plan) {
  std::uint64_t parameters = 0;
  if (!reader.read_text(plan.name) || !reader.read(plan.inode) || !read_command(reader, plan.command) ||
      !reader.read(parameters) || parameters > reader.left()) {
    return false;
  }
  plan.parameters.resize(parameters);
  for (std::string& name : plan.parameters) {
    if (!reader.read_text(name)) return false;
  }
  return reader.read(plan.min_modes) && reader.read(plan.constants) && read_runs(reader, plan);
}

/// Small text files that may not be there.
std::optional<std::string> read_small(const fs::path& file) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return std::nullopt;
  return read_file(file);
}

}  // namespace

std::string new_array_name() {
  std::random_device entropy;
  return fmt::format("mottle-{:08x}", static_cast<std::uint32_t>(entropy()));
}

void write_array(const fs::path& folder, const ArrayPlan& plan, const std::string& number_variable) {
  std::error_code error;
  fs::create_directories(folder, error);
  write_run_file(folder / k_array_mark, "Made by Mottle for runs of a solver, and removed by it.\n");
  for (int task = 1; task <= plan.tasks(); ++task) {
    fs::create_directories(task_folder(folder, task), error);
    // Files that are there before a task starts on another node are seen here without delay.
    write_run_file(task_folder(folder, task) / k_run_store, "");
  }
  write_file_atomically(folder / "job.sh", script_text(folder, number_variable));
  fs::permissions(folder / "job.sh", fs::perms::owner_exec, fs::perm_options::add, error);
  write_plan(folder / k_array, plan, inode_of(folder));
}

std::optional<ArrayPlan> read_array(const fs::path& folder) {
  const std::optional<std::string> bytes = read_small(folder / k_array);
  if (!bytes) return std::nullopt;
  const auto refuse = [&] {
    throw SystemFailure(
        fmt::format("{}: is damaged, or of another version of Mottle; end its tasks by hand and take "
                    "the folder away",
                    (folder / k_array).string()));
  };
  if (!bytes->starts_with(k_magic)) refuse();
  ByteReader reader(std::string_view(*bytes).substr(k_magic.size()));
  Digest sum{};
  const std::size_t head = k_magic.size() + sizeof(sum);
  ArrayPlan plan;
  if (!reader.read(sum) || digest_of(std::string_view(*bytes).substr(head)) != sum || !read_plan(reader, plan))
    refuse();
  return plan;
}

bool is_copied_array(const fs::path& folder, const ArrayPlan& plan) {
  return inode_of(folder) != plan.inode;
}

std::vector<fs::path> array_folders(const fs::path& results) {
  std::vector<fs::path> folders;
  std::error_code ignored;
  fs::directory_iterator entry(results / k_task_folder, ignored);
  for (; entry != fs::directory_iterator(); entry.increment(ignored)) {
    const bool is_folder = entry->symlink_status(ignored).type() == fs::file_type::directory;
    if (is_folder && fs::exists(entry->path() / k_array_mark, ignored)) folders.push_back(entry->path());
  }
  std::ranges::sort(folders);
  return folders;
}

void write_array_job(const fs::path& folder, const std::string& job) {
  write_file_atomically(folder / k_job, job + "\n");
}

std::optional<std::string> read_array_job(const fs::path& folder) {
  std::optional<std::string> text = read_small(folder / k_job);
  if (text) text->resize(std::min(text->size(), text->find('\n')));
  return text;
}

fs::path task_folder(const fs::path& array, int task) {
  return array / fmt::format("task-{}", task);
}

void write_task_end(const fs::path& array, int task, const TaskEnd& end) {
  write_file_atomically(array / fmt::format("task-{}.done", task),
                        fmt::format("{} {} {}\n", end.runs, end.bytes, end.seconds));
}

std::optional<TaskEnd> read_task_end(const fs::path& array, int task) {
  const std::optional<std::string> text = read_small(array / fmt::format("task-{}.done", task));
  if (!text) return std::nullopt;
  std::istringstream words(*text);
  TaskEnd end;
  if (!(words >> end.runs >> end.bytes >> end.seconds)) return std::nullopt;
  return end;
}

void remove_array(const fs::path& folder) {
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  fs::remove(folder.parent_path(), ignored);  // where it is empty
}

fs::path cancel_mark(const fs::path& results) {
  return results / k_task_folder / "cancelled";
}

}  // namespace mottle::drivers
