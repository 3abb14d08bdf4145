// A fuzz target without libFuzzer, for every build: each file of a corpus, then so many damaged copies of each.
//   NAME FOLDER [COPIES]
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>

#include "base/random.h"
#include "tests/fuzz/target.h"
#include "tests/support/temp_dir.h"

namespace {

/// What the target is at, for the one who must repeat it; written before each call, read by a handler of signals.
char at[512] = "";

extern "C" void TellPlace(int signal) {
  std::fputs(at, stderr);
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

/// Numbers that are the same in every build.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : seed_(seed) {}
  std::size_t Below(std::size_t bound) { return dynoproof::RandomBits(seed_, 0, next_++) % bound; }

 private:
  std::uint64_t seed_, next_ = 0;
};

/// One thing happens to the bytes: what disks, editors and senders do.
void Damage(std::string& bytes, Dice& dice) {
  static constexpr const char* kWords[] = {"nan", "inf", "-", "1e999", "\n", "\"", "[", ";", "=", "\xff", "0x", "\x1b"};
  const auto below = [&](std::size_t bound) { return dice.Below(bound); };
  if (bytes.empty()) return;
  const std::size_t place = below(bytes.size()), length = 1 + below(std::min<std::size_t>(64, bytes.size() - place));
  switch (below(6)) {
    case 0:
      bytes[place] = static_cast<char>(bytes[place] ^ (1 << below(8)));
      break;
    case 1:
      bytes.resize(place);
      break;
    case 2:
      bytes.erase(place, length);
      break;
    case 3:
      bytes.insert(place, bytes.substr(place, length));
      break;
    case 4:
      bytes.replace(place, 1, kWords[below(std::size(kWords))]);
      break;
    default:
      bytes.replace(place, length, bytes.substr(below(bytes.size()), length));
      break;
  }
}

void Try(const std::string& bytes) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

}  // namespace

int main(int argc, char** argv) {
  namespace fs = std::filesystem;
  if (argc < 2 || argc > 3 || !fs::is_directory(argv[1])) {
    std::fprintf(stderr, "usage: %s FOLDER [COPIES]\n", argv[0]);
    return 2;
  }
  const long copies = argc > 2 ? std::strtol(argv[2], nullptr, 10) : 0;
  for (const int signal : {SIGABRT, SIGSEGV, SIGFPE, SIGBUS}) std::signal(signal, TellPlace);
  const auto place = [&](const fs::path& file, long copy) {
    std::snprintf(at, sizeof at, "fuzz: while reading %s, damaged copy %ld\n", file.c_str(), copy);
  };
  std::set<fs::path> files;
  for (const auto& entry : fs::directory_iterator(argv[1])) files.insert(entry.path());
  for (const fs::path& file : files) {
    const std::string whole = dynoproof::test::ReadBytes(file);
    place(file, 0);
    Try(whole);
    Dice dice(whole.size());
    for (long copy = 1; copy <= copies; ++copy) {
      std::string bytes = whole;
      for (long times = 1 + copy % 3; times > 0; --times) Damage(bytes, dice);
      place(file, copy);
      Try(bytes);
    }
  }
  std::printf("%zu files, each with %ld damaged copies\n", files.size(), copies);
  return files.empty() ? 1 : 0;  // nothing tried is nothing shown
}
