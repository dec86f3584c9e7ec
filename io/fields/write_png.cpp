// libpng rather than stb_image_write: it streams rows, has no 2 GB limit, filters each row as suits it, and writes
// texts.
#include "io/fields/write_png.h"

#include <png.h>

#include <csetjmp>
#include <exception>

namespace raycone {
namespace {

// libpng leaves by longjmp, which must pass no C++ frame: what OutputFile throws waits here meanwhile.
struct Sink {
  OutputFile& output;
  std::exception_ptr failure;
};

void write_bytes(png_structp png, png_bytep data, png_size_t size) {
  Sink& sink = *static_cast<Sink*>(png_get_io_ptr(png));
  try {
    sink.output.write(data, size);
    return;
  } catch (...) {
    sink.failure = std::current_exception();
  }
  png_error(png, "");
}

void flush_nothing(png_structp) {}

[[noreturn]] void leave(png_structp png, png_const_charp) { png_longjmp(png, 1); }

void ignore_warning(png_structp, png_const_charp) {}

class PngWriter {
 public:
  explicit PngWriter(OutputFile& output)
      : sink_{output, nullptr},
        png_(png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, leave, ignore_warning)),
        info_(png_ ? png_create_info_struct(png_) : nullptr) {
    if (!info_) {
      png_destroy_write_struct(&png_, nullptr);
      throw std::bad_alloc();
    }
    png_set_write_fn(png_, &sink_, write_bytes, flush_nothing);
  }
  ~PngWriter() { png_destroy_write_struct(&png_, &info_); }
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;

  void write(const PngDescription& description, std::span<const std::uint8_t> rgb) {
    std::vector<png_text> texts = png_texts(description);
    if (write_or_fail(description, texts, rgb)) return;
    if (sink_.failure) std::rethrow_exception(sink_.failure);
    throw std::bad_alloc();  // all else that libpng refuses is excluded
  }

 private:
  static std::vector<png_text> png_texts(const PngDescription& description) {
    std::vector<png_text> texts;
    for (const auto& [keyword, text] : description.texts) {
      png_text entry{};
      entry.compression = PNG_ITXT_COMPRESSION_NONE;  // UTF-8
      entry.key = const_cast<char*>(keyword.c_str());
      entry.text = const_cast<char*>(text.c_str());
      texts.push_back(entry);
    }
    return texts;
  }

  // No destructor may be due in here: libpng jumps back to the top.
  bool write_or_fail(const PngDescription& description, std::span<png_text> texts, std::span<const std::uint8_t> rgb) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    const auto width = static_cast<png_uint_32>(description.width);
    const auto height = static_cast<png_uint_32>(description.height);
    png_set_user_limits(png_, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    png_set_IHDR(png_, info_, width, height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_BASE,
                 PNG_FILTER_TYPE_BASE);
    png_set_sRGB(png_, info_, PNG_sRGB_INTENT_PERCEPTUAL);
    png_set_text(png_, info_, texts.data(), static_cast<int>(texts.size()));
    png_write_info(png_, info_);
    for (png_uint_32 row = 0; row < height; ++row) png_write_row(png_, rgb.data() + std::size_t{3} * width * row);
    png_write_end(png_, info_);
    return true;
  }

  Sink sink_;
  png_structp png_;
  png_infop info_;
};

}  // namespace

void write_png(OutputFile& output, const PngDescription& description, std::span<const std::uint8_t> rgb) {
  PngWriter(output).write(description, rgb);
  output.commit();
}

}  // namespace raycone
