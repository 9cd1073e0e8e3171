//! Status that every function returns. The numbers never change; those of the header are tested
//! against these.

use core::ffi::{CStr, c_char};
use inference::ImageError;

/// 0, or the reason why a call was refused. `int32_t` in C and no enum, whose size depends on the
/// options of a C compiler.
pub(crate) type Status = i32;

/// The call was carried out.
pub(crate) const OK: Status = 0;
/// A pointer is null.
pub(crate) const NULL: Status = 1;
/// A pointer is not aligned for its object.
pub(crate) const ALIGNMENT: Status = 2;
/// The storage contains no model.
pub(crate) const NOT_LOADED: Status = 3;
/// First status of a refused image; the others follow in the order of [`ImageError::cause`].
pub(crate) const IMAGE: Status = 16;
/// The image is longer than an object can be.
pub(crate) const IMAGE_LENGTH: Status = IMAGE;

/// Texts of the refused images from [`IMAGE`] on.
const IMAGE_TEXTS: [&CStr; 12] = [
    c"image: its size is not the one that its header declares",
    c"image: the first bytes are not those of a model image",
    c"image: the format version is not the one that this library reads",
    c"image: it ends before its networks do",
    c"image: the checksum is wrong",
    c"image: no bearing has its code",
    c"image: a layer has another shape than this library's",
    c"image: a field of the header is out of its range",
    c"image: a sum of a layer could overflow",
    c"image: a scale of a layer is out of its range",
    c"image: its address is not divisible by 4",
    c"image: bytes follow the last layer",
];

/// Returns the status of a refused image.
pub(crate) fn of_image(error: &ImageError) -> Status {
    IMAGE.wrapping_add(Status::from(error.cause()))
}

/// Returns the meaning of a status in English, a constant text that is never null.
#[unsafe(no_mangle)]
pub extern "C" fn pintle_status_text(status: Status) -> *const c_char {
    let image = status.checked_sub(IMAGE).and_then(|cause| usize::try_from(cause).ok());
    let text = match status {
        OK => c"done",
        NULL => c"a pointer is null",
        ALIGNMENT => c"a pointer is not aligned for its object",
        NOT_LOADED => c"the storage contains no model: call pintle_model_init first",
        _ => image.and_then(|cause| IMAGE_TEXTS.get(cause).copied()).unwrap_or(c"not a status"),
    };
    text.as_ptr()
}
