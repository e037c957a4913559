// SPDX-License-Identifier: Apache-2.0
// What a function reaches, and that it does the same wherever it is laid out.
#include "regression/code/plugin_code.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "mjcf/test/error_of.h"
#include "regression/code/layouts.h"
#include "regression/host/child.h"
#include "regression/host/files.h"

namespace tauext::gate {
namespace {

using tauext::test::error_of;

const std::string kEnd = "\t.section\t.note.GNU-stack,\"\",@progbits\n";

// a plug-in's code, as tauext_add_plugin leaves it
class Code : public testing::Test {
 protected:
  PluginCode of(const std::string& assembly, const std::string& other = "") {
    write("0.s", assembly + kEnd);
    write("1.s", other + kEnd);
    link(folder_.path() + "\ng++\n-shared\n-o\n@out\n@0\n" + (other.empty() ? "" : "@1\n"));
    return PluginCode(plugin());
  }
  // the compiler's assembly of C++
  PluginCode compiled(const std::string& source) {
    const std::string file = folder_.path() + "/x.cc", out = folder_.path() + "/x.s";
    std::ofstream(file) << source;
    run_child(
        {"g++", "-O2", "-fPIC", "-ffunction-sections", "-fdata-sections", "-S", file, "-o", out});
    std::ifstream in(out);
    return of({std::istreambuf_iterator<char>(in), {}});
  }
  // where to link, and how; what is linked is another thing here
  void link(const std::string& text) const {
    std::ofstream(plugin()) << "a plug-in";
    write("link", run_child({"sha256sum", plugin()}).substr(0, 64) + "\n" + text);
  }
  std::string plugin() const { return folder_.path() + "/x.so"; }
  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories(plugin() + ".code");
    std::ofstream(plugin() + ".code/" + name) << text;
  }

  TemporaryFolder folder_;
};

// a function that reads a constant and calls another by a table
std::string program(const std::string& name, const std::string& label, const std::string& table,
                    const std::string& constant = "1078530011") {
  return fmt::format(R"(	.section	.text.{0},"ax",@progbits
	.type	{0}, @function
{0}:
.LFB{1}:
	.cfi_startproc
	testl	%edi, %edi
	je	.L{1}
	movss	.LC{1}(%rip), %xmm0
	leaq	_table(%rip), %rax
	jmp	*8(%rax)
	.p2align 4
.L{1}:
	ret
	.cfi_endproc
	.size	{0}, .-{0}
	.section	.text.one,"ax",@progbits
	.type	one, @function
one:
	movl	$1, %eax
	ret
	.type	two, @function
two:
	movl	$2, %eax
	ret
	.type	unused, @function
unused:
	movl	$3, %eax
	ret
	.section	.data.rel.ro.local._table,"aw"
_table:
{2}	.section	.rodata.cst4,"aM",@progbits,4
.LC{1}:
	.long	{3}
	.section	.bss.counter,"aw",@nobits
counter:
	.zero	8
)",
                     name, label, table, constant);
}
const std::string kOneTwo = "\t.quad\tone\n\t.quad\ttwo\n",
                  kTwoOne = "\t.quad\ttwo\n\t.quad\tone\n";

TEST_F(Code, IsTheSameWhateverItsNamesAre) {
  const std::string one = of(program("_Z1fv", "7", kOneTwo)).reached("_Z1fv");
  EXPECT_EQ(one, of(program("_Z1gv", "12", kOneTwo)).reached("_Z1gv"));
  EXPECT_NE(one.find("movl\t$2, %eax"), std::string::npos) << "what the table leads to:\n" << one;
  EXPECT_EQ(one.find("movl\t$3, %eax"), std::string::npos) << "what nobody calls:\n" << one;
}

TEST_F(Code, IsAnotherWhereATableOrAConstantIs) {
  const std::string one = of(program("f", "7", kOneTwo)).reached("f");
  EXPECT_NE(one, of(program("f", "7", kTwoOne)).reached("f")) << "two functions swapped";
  EXPECT_NE(one, of(program("f", "7", kOneTwo, "0")).reached("f"));
}

std::string function(const std::string& name, const std::string& lines) {
  return fmt::format("\t.type\t{0}, @function\n{0}:\n{1}\tret\n", name, lines);
}

TEST_F(Code, KnowsWhichFunctionOfAnotherUnitIsCalled) {
  const std::string g = function("g", "\tmovl\t$1, %eax\n"), h = function("h", "\tnop\n");
  // both units name both of them, in another order
  const std::string others = g + h + function("k", "\tcall\th\n\tcall\tg\n");
  const auto calls = [&](const std::string& which) {
    return of(function("f", "\tcall\tk\n\tcall\tg\n\tcall\th@PLT\n\tcall\t" + which + "\n"), others)
        .reached("f");
  };
  EXPECT_NE(calls("g"), calls("h"));
  const auto alias_of = [&](const std::string& which) {
    return of(function("f", "\tcall\tk\n\tcall\tb\n"), others + "\t.set\tb, " + which + "\n")
        .reached("f");
  };
  EXPECT_NE(alias_of("g"), alias_of("h"));
  EXPECT_NE(alias_of("b"), alias_of("g")) << "a circle is nobody's name";
}

TEST_F(Code, KnowsWhereAJumpGoesInEachCompilersLabels) {
  for (const std::string label : {".L4", ".LBB0_1", ".LVL7"}) {
    const auto to = [&](const std::string& before, const std::string& behind) {
      return of(function("f", before + "\tincl\t%eax\n" + behind + "\tjne\t" + label + "\n"))
          .reached("f");
    };
    EXPECT_NE(to(label + ":\n", ""), to("", label + ":\n")) << label;
    EXPECT_EQ(to(label + ":\n.Ltmp9:\n", ""), to(label + ":\n", ".LFE1:\n"))
        << "labels that nobody mentions";
  }
}

TEST_F(Code, FollowsConstantsThatAreAPartOfOthers) {
  const auto with = [&](const std::string& numbers, const std::string& at) {
    return of(function("f", "\tmovsd\t.LC1(%rip), %xmm0\n") + "\t.set\t.LC1,.LC2" + at +
              "\n\t.set\t.LC2,.LC3+8\n\t.section\t.rodata\n.LC3:\n" + numbers)
        .reached("f");
  };
  const std::string numbers = "\t.quad\t1\n\t.quad\t2\n\t.quad\t3\n";
  EXPECT_NE(with(numbers, "+8"), with("\t.quad\t1\n\t.quad\t2\n\t.quad\t4\n", "+8"));
  EXPECT_NE(with(numbers, "+8"), with(numbers, ""));
}

TEST_F(Code, IsNotClaimedWhereMemoryIsReachedThatMayChange) {
  EXPECT_EQ(of(program("f", "7", kOneTwo + "\t.quad\tcounter\n")).reached("f"), "");
  EXPECT_EQ(of(program("f", "7", kOneTwo + "\t.quad\t.LANCHOR0+8\n")).reached("f"), "")
      << "data by way of a label that is not there";
}

TEST_F(Code, FollowsJumpTablesAndColdParts) {
  const std::string source = R"(
    extern "C" [[gnu::noinline]] int g(int x) { return x * 37 + NUMBER; }
    extern "C" [[gnu::cold, gnu::noinline]] int rare(int x) { return x + 11; }
    extern "C" int f(int x) {
      if (__builtin_expect(x > 1000, 0)) return rare(x);
      switch (x) { case 0: return 5; case 1: return g(9); case 2: return -3; case 3: return g(x) / 7;
        case 4: return 99; case 5: return g(2) % 5; case 6: return 1; }
      return 0;
    })";
  const std::string a = compiled("#define NUMBER 3\n" + source).reached("f");
  EXPECT_EQ(
      a, compiled("int before(int x) { return x + 1; }\n#define NUMBER 3\n" + source).reached("f"));
  EXPECT_NE(a, compiled("#define NUMBER 4\n" + source).reached("f"));
}

// where a function of a library lies, and what it says
struct Loaded {
  explicit Loaded(const std::string& path)
      : library(::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL), ::dlclose) {}
  std::uintptr_t address(const char* name) const {
    return reinterpret_cast<std::uintptr_t>(::dlsym(library.get(), name));
  }
  int call(const char* name, int x) const {
    return reinterpret_cast<int (*)(int)>(address(name))(x);
  }
  std::unique_ptr<void, int (*)(void*)> library;
};

TEST_F(Code, DoesTheSameInEveryLayout) {
  const PluginCode code = compiled(R"(
    extern "C" [[gnu::noinline]] int g(int x) { return x < 2 ? 1 : x * g(x - 1); }
    extern "C" int f(int x) { int s = 0; for (int i = 0; i < x; ++i) s += g(i); return s; })");
  std::set<std::uintptr_t> places;
  for (int seed = 0; seed < 16; ++seed) {
    const std::string path = fmt::format("{}/{}.so", folder_.path(), seed);
    code.lay_out(static_cast<std::uint64_t>(seed), {}, path);
    const Loaded l(path);
    EXPECT_EQ(l.call("f", 6), 1 + 1 + 2 + 6 + 24 + 120);
    EXPECT_EQ(l.address("f") % 16, 0u);
    places.insert(l.address("f") % 512);
  }
  EXPECT_GT(places.size(), 8u) << "16 layouts, 32 places";
}

TEST_F(Code, LiesWhereBaseLiesThoughItHasAnotherName) {
  const std::string rest =
      "(int x) { return x * 77 + 5; }\nextern \"C\" int f(int x) { return x; }";
  const PluginCode base = compiled("extern \"C\" int before" + rest);
  const PluginCode head = compiled("extern \"C\" int after" + rest);
  const LayoutNames names = paired_names(base, head);
  ASSERT_EQ(names.size(), 1u);
  EXPECT_EQ(names.at("after"), "before");
  const std::string b = folder_.path() + "/b.so", h = folder_.path() + "/h.so";
  base.lay_out(3, {}, b);
  head.lay_out(3, names, h);
  EXPECT_EQ(Loaded(b).address("before") % 512, Loaded(h).address("after") % 512);
  EXPECT_EQ(Loaded(b).address("f") % 512, Loaded(h).address("f") % 512);
}

TEST_F(Code, SaysWhatIsMissing) {
  const std::string folder = plugin() + ".code";
  const auto error = [&] { return error_of([&] { PluginCode code(plugin()); }); };
  EXPECT_EQ(error(), folder + "/link: No such file or directory; tauext_add_plugin writes it");
  link("/\ng++\n");
  EXPECT_EQ(error(), folder + "/link: cut off; build the plug-in anew");
  link("/\ng++\n-shared\n@0\n");
  EXPECT_EQ(error(), folder + "/0.s: No such file or directory");
  write("0.s", "nothing");
  EXPECT_EQ(error(), folder + "/0.s: cut off, or no assembly of g++ or clang++; build it anew");
  const std::string whole = program("f", "7", kOneTwo) + kEnd;
  write("0.s", whole.substr(0, whole.size() - 10));
  EXPECT_EQ(error(), folder + "/0.s: cut off, or no assembly of g++ or clang++; build it anew");
  write("0.s", kEnd);
  EXPECT_EQ(error(), folder + "/0.s: holds no function");
  write("0.s", whole);
  link("/nowhere\ng++\n-shared\n-o\n@out\n@0\n");
  EXPECT_EQ(
      error_of([&] { PluginCode(plugin()).lay_out(1, {}, plugin()); }),
      folder +
          "/: g++ cannot assemble and link it in /nowhere, as its link says; build it here anew");
  std::ofstream(plugin()) << "another one";
  EXPECT_EQ(error(), folder + ": is of another build than the plug-in beside it; copy both");
  EXPECT_EQ(error_of([&] { (void)of(program("f", "7", kOneTwo)).reached("g"); }),
            plugin() + ": g is not in its assembly");
}

}  // namespace
}  // namespace tauext::gate
