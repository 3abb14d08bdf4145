// What happens to files that people handle: a value becomes NaN, a signal is lost, a copy is cut short. All through the
// HDF5 library alone, as a stranger's program would do it.
#pragma once

#include <hdf5.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

namespace dynoproof::test {

/// Opens the file for writing and lets `edit` do its work.
inline void Spoil(const std::filesystem::path& path, const std::function<void(hid_t)>& edit) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  if (file < 0) throw std::runtime_error("cannot open " + path.string());
  edit(file);
  H5Fclose(file);
}

/// The numbers of a dataset with one extent.
inline std::vector<double> Numbers(hid_t file, const std::string& name) {
  const hid_t set = H5Dopen2(file, name.c_str(), H5P_DEFAULT), space = H5Dget_space(set);
  std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  H5Sclose(space);
  H5Dclose(set);
  return values;
}

/// Replaces numbers in place.
inline void Overwrite(hid_t file, const std::string& name, const std::vector<double>& values) {
  const hid_t set = H5Dopen2(file, name.c_str(), H5P_DEFAULT);
  H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  H5Dclose(set);
}

/// Makes value `index` of a dataset another.
inline void SetValue(const std::filesystem::path& path, const std::string& name, std::size_t index, double value) {
  Spoil(path, [&](hid_t file) {
    std::vector<double> values = Numbers(file, name);
    values.at(index) = value;
    Overwrite(file, name, values);
  });
}

inline void Delete(const std::filesystem::path& path, const std::string& name) {
  Spoil(path, [&](hid_t file) { H5Ldelete(file, name.c_str(), H5P_DEFAULT); });
}

/// Puts a dataset with other numbers, without attributes unless `like` names one to take them from, in its place.
inline void Put(hid_t file, const std::string& name, const std::vector<double>& values, const std::string& like = "") {
  const hid_t old = like.empty() ? H5I_INVALID_HID : H5Dopen2(file, like.c_str(), H5P_DEFAULT);
  if (H5Lexists(file, name.c_str(), H5P_DEFAULT) > 0) H5Ldelete(file, name.c_str(), H5P_DEFAULT);
  const hsize_t extent = values.size();
  const hid_t space = H5Screate_simple(1, &extent, nullptr);
  const hid_t set = H5Dcreate2(file, name.c_str(), H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  for (const char* key : {"unit", "description", "nominal", "interpolation"}) {
    if (old < 0 || H5Aexists(old, key) <= 0) continue;
    const hid_t from = H5Aopen(old, key, H5P_DEFAULT), type = H5Aget_type(from), one = H5Aget_space(from);
    const hid_t to = H5Acreate2(set, key, type, one, H5P_DEFAULT, H5P_DEFAULT);
    if (H5Tis_variable_str(type) > 0) {
      char* text = nullptr;
      H5Aread(from, type, &text);
      H5Awrite(to, type, &text);
      H5free_memory(text);
    } else {
      std::vector<char> bytes(std::max<std::size_t>(1, H5Tget_size(type)));
      H5Aread(from, type, bytes.data());
      H5Awrite(to, type, bytes.data());
    }
    H5Aclose(to);
    H5Sclose(one);
    H5Tclose(type);
    H5Aclose(from);
  }
  if (old >= 0) H5Dclose(old);
  H5Dclose(set);
  H5Sclose(space);
}

}  // namespace dynoproof::test
