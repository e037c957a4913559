// SPDX-License-Identifier: Apache-2.0
#include "regression/code/elf.h"

#include <elf.h>

#include <cstring>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "mjcf/trace/input_file.h"

namespace tauext::gate {
namespace {

// a struct at an offset of the file
template <class T>
T at(const std::string& bytes, std::uint64_t offset, const std::string& path) {
  if (offset > bytes.size() || bytes.size() - offset < sizeof(T)) {
    throw std::runtime_error(path + ": an ELF file that is cut off");
  }
  T x;
  std::memcpy(&x, bytes.data() + offset, sizeof(T));
  return x;
}

// calls visit(name, content) for every section of the file that has content
template <class Visit>
void for_each_section(const std::string& bytes, const std::string& path, Visit&& visit) {
  if (bytes.size() < sizeof(Elf64_Ehdr) || std::memcmp(bytes.data(), ELFMAG, SELFMAG) != 0 ||
      bytes[EI_CLASS] != ELFCLASS64) {
    throw std::runtime_error(path + ": no ELF file of 64 bit");
  }
  const auto head = at<Elf64_Ehdr>(bytes, 0, path);
  const auto section = [&](std::uint64_t i) {
    return at<Elf64_Shdr>(bytes, head.e_shoff + i * sizeof(Elf64_Shdr), path);
  };
  const Elf64_Shdr names = section(head.e_shstrndx);
  for (std::uint64_t i = 0; i < head.e_shnum; ++i) {
    const Elf64_Shdr s = section(i);
    at<char>(bytes, names.sh_offset + s.sh_name, path);
    if (s.sh_type == SHT_NOBITS || s.sh_size == 0) continue;
    at<char>(bytes, s.sh_offset + s.sh_size - 1, path);
    visit(std::string_view(bytes.c_str() + names.sh_offset + s.sh_name),
          std::string_view(bytes).substr(s.sh_offset, s.sh_size));
  }
}

}  // namespace

std::vector<std::string> needed_libraries(const std::string& path) {
  const std::string bytes = read_whole(path);
  std::string_view names, entries;
  for_each_section(bytes, path, [&](std::string_view name, std::string_view content) {
    if (name == ".dynstr") names = content;
    if (name == ".dynamic") entries = content;
  });
  std::vector<std::string> needed;
  for (std::size_t i = 0; i + sizeof(Elf64_Dyn) <= entries.size(); i += sizeof(Elf64_Dyn)) {
    Elf64_Dyn d;
    std::memcpy(&d, entries.data() + i, sizeof d);
    if (d.d_tag != DT_NEEDED || d.d_un.d_val >= names.size()) continue;
    const std::string_view rest = names.substr(d.d_un.d_val);
    needed.emplace_back(rest.substr(0, rest.find('\0')));
  }
  return needed;
}

std::string function_at(const std::string& path, std::uint64_t address) {
  const std::string bytes = read_whole(path);
  std::string_view names, entries;
  for_each_section(bytes, path, [&](std::string_view name, std::string_view content) {
    if (name == ".strtab") names = content;
    if (name == ".symtab") entries = content;
  });
  for (std::size_t i = 0; i + sizeof(Elf64_Sym) <= entries.size(); i += sizeof(Elf64_Sym)) {
    Elf64_Sym s;
    std::memcpy(&s, entries.data() + i, sizeof s);
    if (ELF64_ST_TYPE(s.st_info) != STT_FUNC || s.st_value != address) continue;
    if (s.st_name >= names.size()) continue;
    const std::string_view rest = names.substr(s.st_name);
    return std::string(rest.substr(0, rest.find('\0')));
  }
  throw std::runtime_error(path + ": no function begins where its kernel does; is it stripped?");
}

}  // namespace tauext::gate
