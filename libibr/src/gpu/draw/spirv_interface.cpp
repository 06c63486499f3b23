// SPDX-License-Identifier: Apache-2.0
#include "gpu/draw/spirv_interface.h"

#include <algorithm>
#include <tuple>

#include "base/check.h"

namespace ibr {
namespace {

// Opcodes.
constexpr std::uint32_t kName = 5, kEntryPoint = 15, kExecutionMode = 16, kCapability = 17;
constexpr std::uint32_t kBool = 20, kInt = 21, kFloat = 22, kVector = 23, kMatrix = 24, kImage = 25, kSampler = 26;
constexpr std::uint32_t kSampledImage = 27, kArray = 28, kRuntimeArray = 29, kStruct = 30, kPointer = 32;
constexpr std::uint32_t kConstant = 43, kSpecTrue = 48, kSpecFalse = 49, kSpecConstant = 50, kVariable = 59;
constexpr std::uint32_t kDecorate = 71, kMemberDecorate = 72;
// Decorations.
constexpr std::uint32_t kSpecId = 1, kRowMajor = 4, kArrayStride = 6, kMatrixStride = 7, kBuiltIn = 11, kFlat = 14;
constexpr std::uint32_t kNoPerspective = 13, kNonWritable = 24, kLocation = 30, kComponent = 31, kBinding = 33;
constexpr std::uint32_t kDescriptorSet = 34, kOffset = 35;
// Storage classes.
constexpr std::uint32_t kUniformConstant = 0, kInput = 1, kUniform = 2, kOutput = 3, kPushConstant = 9, kBuffer = 12;

constexpr std::uint32_t kWhole = 0xffffffff;  // in place of a member's number: the type or variable itself

// SPIR-V defines identifiers before their uses, so one pass over the words is enough.
class SpirvReader {
 public:
  explicit SpirvReader(std::span<const std::uint32_t> words) : words_(words) {
    constexpr std::uint32_t kMagic = 0x07230203, kHeader = 5;
    check(words.size() >= kHeader && words[0] == kMagic, ErrorCode::invalidInput, "not SPIR-V: the header is missing");
    for (at_ = kHeader; at_ < words.size(); at_ += count_) {
      count_ = words[at_] >> 16;
      check(count_ > 0 && count_ <= words.size() - at_, ErrorCode::invalidInput,
            "SPIR-V, word {}: instruction of {} words, but only {} are left", at_, count_, words.size() - at_);
      instruction(words[at_] & 0xffff);
    }
    check(entryPoints_ == 1, ErrorCode::invalidInput, "SPIR-V: {} entry points instead of 1", entryPoints_);
  }

  SpirvInterface result;

 private:
  struct Type {
    std::string text;
    std::uint64_t bytes = 0;      // in a buffer, matrices excluded; 0 if undefined
    std::uint64_t count = 0;      // components of a vector, columns of a matrix
    std::uint64_t rows = 0;       // of a matrix
    std::uint32_t stride = 0;     // of a runtime array, or of the one that ends a structure
    std::uint32_t structure = 0;  // the structure's id, also for an array of structures
  };

  std::uint32_t word(std::uint32_t i) const {
    check(i < count_, ErrorCode::invalidInput, "SPIR-V, word {}: instruction {} is truncated", at_,
          words_[at_] & 0xffff);
    return words_[at_ + i];
  }
  std::string text(std::uint32_t i) const {
    std::string text;
    for (; i < count_; ++i)
      for (int shift = 0; shift < 32; shift += 8) {
        const char c = char(words_[at_ + i] >> shift & 0xff);
        if (c == 0) return text;
        text += c;
      }
    fail(ErrorCode::invalidInput, "SPIR-V, word {}: unterminated string", at_);
  }
  const Type& type(std::uint32_t id) const {
    const auto found = types_.find(id);
    check(found != types_.end(), ErrorCode::invalidInput, "SPIR-V, word {}: type {} is not defined", at_, id);
    return found->second;
  }
  bool has(std::uint32_t id, std::uint32_t decoration, std::uint32_t member = kWhole) const {
    return decorations_.contains({id, member, decoration});
  }
  std::uint32_t value(std::uint32_t id, std::uint32_t decoration, std::uint32_t member = kWhole) const {
    const auto found = decorations_.find({id, member, decoration});
    return found == decorations_.end() ? 0 : found->second;
  }
  std::string nameOf(std::uint32_t id) const {
    const auto found = names_.find(id);
    return found == names_.end() ? std::string() : found->second;
  }
  // Limits the text of nested types.
  static std::string shortened(const std::string& text) {
    constexpr std::size_t kMaxBytes = 200;
    return text.substr(0, kMaxBytes);
  }
  void define(Type type) {
    type.text = shortened(type.text);
    types_[word(1)] = std::move(type);
  }

  void instruction(std::uint32_t operation) {
    constexpr std::uint32_t kLocalSize = 17;
    if (operation == kName) {
      names_[word(1)] = text(2);
    } else if (operation == kCapability) {
      result.capabilities.insert(word(1));
    } else if (operation == kEntryPoint) {
      ++entryPoints_;
      result.stage = word(1);
      result.entryPoint = text(3);
    } else if (operation == kExecutionMode && word(2) == kLocalSize) {
      result.workgroup = {word(3), word(4), word(5)};
    } else if (operation == kDecorate) {
      decorations_[{word(1), kWhole, word(2)}] = count_ > 3 ? word(3) : 0;
    } else if (operation == kMemberDecorate) {
      decorations_[{word(1), word(2), word(3)}] = count_ > 4 ? word(4) : 0;
    } else if (operation >= kBool && operation <= kStruct) {
      defineType(operation);
    } else if (operation == kPointer) {
      pointees_[word(1)] = word(3);
    } else if (operation == kConstant || (operation >= kSpecTrue && operation <= kSpecConstant)) {
      const std::uint32_t id = word(2);
      if (operation == kConstant || operation == kSpecConstant) numbers_[id] = word(3);
      if (has(id, kSpecId)) result.constants[{value(id, kSpecId), 0}] = {type(word(1)).text, nameOf(id)};
    } else if (operation == kVariable) {
      variable(word(1), word(2), word(3));
    }
  }

  void defineType(std::uint32_t operation) {
    if (operation == kBool) define({.text = "bool"});
    if (operation == kInt) define({.text = fmt::format("{}int{}", word(3) ? "" : "u", word(2)), .bytes = word(2) / 8});
    if (operation == kFloat) define({.text = fmt::format("float{}", word(2)), .bytes = word(2) / 8});
    if (operation == kSampler) define({.text = "sampler"});
    if (operation == kSampledImage) define({.text = "sampled " + type(word(2)).text});
    if (operation == kStruct) defineStruct();
    if (operation == kImage)
      define({.text = fmt::format("{}image (of {}, dimensions {}, depth {}, layers {}, samples {}, format {})",
                                  word(7) == 2 ? "storage " : "", type(word(2)).text, word(3), word(4), word(5),
                                  word(6), word(8))});
    if (operation < kVector || operation > kRuntimeArray || (operation > kMatrix && operation < kArray)) return;
    const Type& element = type(word(2));
    if (operation == kVector)
      define({.text = fmt::format("{}x{}", element.text, word(3)), .bytes = element.bytes * word(3), .count = word(3)});
    if (operation == kMatrix)
      define({.text = fmt::format("{} columns of {}", word(3), element.text), .count = word(3), .rows = element.count});
    const std::uint32_t stride = value(word(1), kArrayStride);
    if (operation == kRuntimeArray)
      define({.text = "runtime array of " + element.text, .stride = stride, .structure = element.structure});
    if (operation == kArray) {
      const auto length = numbers_.find(word(3));
      const std::uint64_t elements = length == numbers_.end() ? 0 : length->second;
      define({fmt::format("{} of {}", elements, element.text), elements * stride, 0, 0, 0, element.structure});
    }
  }

  void defineStruct() {
    const std::uint32_t id = word(1);
    Type all{.structure = id};
    for (std::uint32_t m = 0; m + 2 < count_; ++m) {
      const Type& member = type(word(m + 2));
      const std::uint64_t lines = has(id, kRowMajor, m) ? member.rows : member.count;
      const std::uint64_t bytes = member.rows > 0 ? value(id, kMatrixStride, m) * lines : member.bytes;
      all.bytes = std::max(all.bytes, value(id, kOffset, m) + bytes);
      all.stride = std::max(all.stride, member.stride);
      all.text = shortened(all.text + (m > 0 ? ", " : "") + member.text);
    }
    if (has(id, kOffset, 0)) all.text = fmt::format("block of {} bytes, array stride {}", all.bytes, all.stride);
    define(std::move(all));
  }

  void variable(std::uint32_t pointer, std::uint32_t id, std::uint32_t storage) {
    const auto pointee = pointees_.find(pointer);
    check(pointee != pointees_.end(), ErrorCode::invalidInput, "SPIR-V, word {}: pointer {} is not defined", at_,
          pointer);
    if (storage == kPushConstant) {
      result.pushConstantBytes = std::max(result.pushConstantBytes, type(pointee->second).bytes);
    } else if (storage == kUniformConstant || storage == kUniform || storage == kBuffer) {
      const Type& kind = type(pointee->second);
      const bool readOnly = has(id, kNonWritable) || (kind.structure && has(kind.structure, kNonWritable, 0));
      std::string text = storage == kUniform ? "uniform " : storage == kBuffer ? "storage " : "";
      text += (readOnly ? "read-only " : "") + kind.text;
      const std::string name = nameOf(id);
      SpirvVariable& bound = result.bindings[{value(id, kDescriptorSet), value(id, kBinding)}];
      if (!bound.type.empty()) text = shortened(bound.type + " and " + text);  // two views of one buffer
      bound = {std::move(text), name.empty() ? nameOf(kind.structure) : name};
    } else if (storage == kInput || storage == kOutput) {
      const Type& kind = type(pointee->second);
      if (has(id, kBuiltIn) || (kind.structure && has(kind.structure, kBuiltIn, 0))) return;
      const std::string how = has(id, kFlat) ? "flat " : has(id, kNoPerspective) ? "noperspective " : "";
      auto& list = storage == kInput ? result.inputs : result.outputs;
      list[{value(id, kLocation), value(id, kComponent)}] = {how + kind.text, nameOf(id)};
    }
  }

  std::span<const std::uint32_t> words_;
  std::size_t at_ = 0;
  std::uint32_t count_ = 0;  // words of the instruction at at_
  int entryPoints_ = 0;
  std::map<std::uint32_t, std::string> names_;
  std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>, std::uint32_t> decorations_;  // id, member, which
  std::map<std::uint32_t, Type> types_;
  std::map<std::uint32_t, std::uint32_t> pointees_;  // types, by pointer type
  std::map<std::uint32_t, std::uint32_t> numbers_;   // values of constants, lowest word
};

}  // namespace

SpirvInterface spirvInterface(std::span<const std::uint32_t> words) {
  return SpirvReader(words).result;
}

}  // namespace ibr
