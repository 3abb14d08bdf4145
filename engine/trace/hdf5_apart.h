// Reading in a process of its own. The HDF5 library trusts what a file says about itself: a damaged file can make it
// write where it must not, or go round for ever. In a process of its own it can do no harm, and its end becomes a
// sentence. The result comes back through a pipe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/status.h"

namespace dynoproof::trace {

/// Writes values to a pipe; false once something went wrong.
class Sender {
 public:
  explicit Sender(int pipe) : pipe_(pipe) {}
  ~Sender() { Flush(); }
  Sender(const Sender&) = delete;
  Sender& operator=(const Sender&) = delete;

  void Bytes(const void* data, std::size_t count);
  bool Flush();

 private:
  int pipe_;
  std::vector<char> waiting_;
  bool ok_ = true;
};

/// Reads them back.
class Receiver {
 public:
  explicit Receiver(int pipe) : pipe_(pipe) {}
  void Bytes(void* data, std::size_t count);
  /// How many of `size` bytes follow; 0 when that cannot be.
  std::size_t Count(std::size_t size);
  bool ok() const { return ok_; }
  bool silent() const { return silent_; }

 private:
  int pipe_;
  bool ok_ = true, silent_ = false;
  std::vector<char> buffer_;
  std::size_t next_ = 0;
};

/// Sends or receives, by the archive's kind, everything that a record or a trace is made of. A type with members of its
/// own has a function Members(archive, value) beside it.
template <class T>
struct IsVector : std::false_type {};
template <class T>
struct IsVector<std::vector<T>> : std::true_type {};
template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};
template <class T>
struct IsPair : std::false_type {};
template <class A, class B>
struct IsPair<std::pair<A, B>> : std::true_type {};

template <class Archive, class T>
void Pass(Archive& archive, T& value) {
  constexpr bool kReceives = std::is_same_v<Archive, Receiver>;
  const auto count = [&](std::size_t now, std::size_t size) {
    if constexpr (kReceives) {
      return archive.Count(size);
    } else {
      const std::uint64_t number = now;
      archive.Bytes(&number, sizeof number);
      return static_cast<std::size_t>(size == 0 ? 0 : now);
    }
  };
  if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
    archive.Bytes(&value, sizeof value);
  } else if constexpr (std::is_same_v<T, std::string>) {
    const std::size_t size = count(value.size(), 1);
    if constexpr (kReceives) value.resize(size);
    archive.Bytes(value.data(), size);
  } else if constexpr (IsVector<T>::value) {
    using Item = typename T::value_type;
    const std::size_t size = count(value.size(), sizeof(Item));
    if constexpr (kReceives) value.resize(size);
    if constexpr (std::is_arithmetic_v<Item>) {
      archive.Bytes(value.data(), size * sizeof(Item));
    } else {
      for (Item& item : value) Pass(archive, item);
    }
  } else if constexpr (IsOptional<T>::value) {
    bool there = value.has_value();
    archive.Bytes(&there, sizeof there);
    if constexpr (kReceives) {
      if (there) value.emplace();
    }
    if (there) Pass(archive, *value);
  } else if constexpr (IsPair<T>::value) {
    Pass(archive, value.first);
    Pass(archive, value.second);
  } else {
    Members(archive, value);
  }
}

template <class Archive>
void Members(Archive& archive, Failure& failure) {
  Pass(archive, failure.message);
  Pass(archive, failure.signal);
  Pass(archive, failure.time_s);
  Pass(archive, failure.exit_code);
}

/// What the other process may take.
struct ApartLimits {
  std::string reader = "the HDF5 library";  // what a sentence calls it
  double cpu_s = 20.0;
  std::uint64_t memory_bytes = std::uint64_t{6} << 30;  // beyond what this process has; not under sanitizers
};

/// Calls `work` in another process and `take` here, with the two ends of a pipe. A failure says how the other process
/// ended (exit code 2), or that there could be none (3).
///
/// The other process is a copy of this one with the calling thread alone. So `work` may take only locks that nobody
/// else can hold meanwhile: that of hdf5::Session is held by the caller already, malloc's are kept safe by the C library
/// (those of the address sanitizer's allocator are not: built so, no other thread may allocate meanwhile).
Status RunApart(const ApartLimits& limits, const std::function<void(Sender&)>& work,
                const std::function<void(Receiver&)>& take);

/// Whether this build reads in the calling process instead, without limits: one for libFuzzer (DYNOPROOF_FUZZ), which sees
/// nothing of what another process does, unless the environment has DYNOPROOF_READ_APART.
bool ReadsHere();

/// The value of `read`, which is called in another process.
template <class T, class Read>
Result<T> ReadApart(const ApartLimits& limits, const Read& read) {
  if (ReadsHere()) return read();
  Failure failure;
  T value{};
  bool ok = false;
  const Status died = RunApart(
      limits,
      [&](Sender& sender) {
        Result<T> result = read();
        bool good = result.ok();
        Pass(sender, good);
        if (good) {
          Pass(sender, *result);
        } else {
          Failure why = result.failure();
          Pass(sender, why);
        }
      },
      [&](Receiver& receiver) {
        Pass(receiver, ok);
        if (ok) {
          Pass(receiver, value);
        } else {
          Pass(receiver, failure);
        }
      });
  if (died) return *died;
  if (!ok) return failure;
  return value;
}

}  // namespace dynoproof::trace
