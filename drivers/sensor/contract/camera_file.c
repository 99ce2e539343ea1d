#include "drivers/sensor/contract/camera_file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

#include "drivers/file/text.h"

enum { CAMERA_FILE_MAX = 65536 };

int iso_camera_file_read(const char *path, struct iso_camera_file *out, struct iso_fault *fault)
{
    struct iso_recording_meta meta;
    char *text = NULL;
    int error = iso_text_read(path, CAMERA_FILE_MAX, &text, fault);
    if (!error) {
        error = iso_recording_meta_parse(path, text, &meta, fault);
    }
    free(text);
    if (error) {
        return iso_fault_code_default(fault, ISO_FAULT_CALIBRATION_WRONG,
                                      error == -ENOENT || error == -ENOMEM ? error : -EINVAL);
    }
    out->meta = meta;
    iso_text_copy_end(path, out->name, sizeof out->name);
    return 0;
}

void iso_camera_file_describe(const struct iso_camera_file *file, char *text, size_t size)
{
    (void)snprintf(text, size, file->meta.nominal ? "nominal (%s)" : "%s", file->name);
}
