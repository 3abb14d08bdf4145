// HDF5 files as others write them, for tests.
#pragma once

#include <hdf5.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "trace/record.h"

namespace dynoproof::test {

/// How a dataset is stored.
struct Hdf5Form {
  std::vector<hsize_t> shape = {};  // empty: as long as the values
  hid_t type = H5T_IEEE_F64LE;
  std::vector<hsize_t> chunk = {};
  bool deflate = false;
  std::vector<hsize_t> first = {};  // only so much of it is written
  bool write = true;
};

class Hdf5File {
 public:
  /// `user_block`: bytes in front, as MATLAB has them.
  explicit Hdf5File(const std::filesystem::path& path, hsize_t user_block = 0) {
    std::filesystem::remove(path);
    const hid_t plist = H5Pcreate(H5P_FILE_CREATE);
    H5Pset_userblock(plist, user_block);
    file_ = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, plist, H5P_DEFAULT);
    H5Pclose(plist);
  }
  ~Hdf5File() { H5Fclose(file_); }
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;

  hid_t id() const { return file_; }
  void Group(const char* name) { H5Gclose(H5Gcreate2(file_, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)); }

  void Numbers(const char* name, const std::vector<double>& values, Hdf5Form form = {}) {
    if (form.shape.empty()) form.shape = {values.size()};
    const int rank = static_cast<int>(form.shape.size());
    const hid_t plist = H5Pcreate(H5P_DATASET_CREATE);
    if (!form.chunk.empty()) H5Pset_chunk(plist, rank, form.chunk.data());
    if (form.deflate) H5Pset_deflate(plist, 6);
    const hid_t space = H5Screate_simple(rank, form.shape.data(), nullptr);
    const hid_t set = H5Dcreate2(file_, name, form.type, space, H5P_DEFAULT, plist, H5P_DEFAULT);
    hid_t memory = H5S_ALL, part = H5S_ALL;
    if (!form.first.empty()) {
      const std::vector<hsize_t> start(form.shape.size(), 0);
      H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, form.first.data(), nullptr);
      memory = H5Screate_simple(rank, form.first.data(), nullptr);
      part = space;
    }
    if (form.write) H5Dwrite(set, H5T_NATIVE_DOUBLE, memory, part, H5P_DEFAULT, values.data());
    if (memory != H5S_ALL) H5Sclose(memory);
    H5Dclose(set);
    H5Sclose(space);
    H5Pclose(plist);
  }

  /// A text of fixed length, filled up by zeros, or of variable length.
  void Text(const char* object, const char* name, const std::string& text, bool variable = false) {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, variable ? H5T_VARIABLE : std::max<std::size_t>(text.size(), 1));
    if (!variable) H5Tset_strpad(type, H5T_STR_NULLPAD);
    const char* const bytes = text.c_str();
    Attribute(object, name, type, type, {}, variable ? static_cast<const void*>(&bytes) : bytes);
    H5Tclose(type);
  }
  /// Several texts in one attribute, each cut to 8 bytes; no text at all is an empty one.
  void Texts(const char* object, const char* name, const std::vector<std::string>& texts) {
    constexpr std::size_t kSize = 8;
    std::string bytes;
    for (const std::string& text : texts) bytes += (text + std::string(kSize, '\0')).substr(0, kSize);
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, kSize);
    H5Tset_strpad(type, H5T_STR_NULLPAD);
    Attribute(object, name, type, type, {texts.size()}, bytes.data());
    H5Tclose(type);
  }
  void Number(const char* object, const char* name, std::vector<double> values, hid_t type = H5T_IEEE_F64LE) {
    Attribute(object, name, type, H5T_NATIVE_DOUBLE,
              values.size() == 1 ? std::vector<hsize_t>{} : std::vector<hsize_t>{values.size()}, values.data());
  }

 private:
  void Attribute(const char* object, const char* name, hid_t type, hid_t memory, const std::vector<hsize_t>& shape,
                 const void* data) {
    const hid_t space =
        shape.empty() ? H5Screate(H5S_SCALAR) : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
    const hid_t attribute = H5Acreate_by_name(file_, object, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, memory, data);
    H5Aclose(attribute);
    H5Sclose(space);
  }

  hid_t file_;
};

/// The values of a column; { -999 } where there is none.
inline std::vector<double> Values(const trace::Record& record, const char* name) {
  const auto column = record.Find(name);
  return column ? record.columns[*column].values : std::vector<double>{-999};
}

}  // namespace dynoproof::test
