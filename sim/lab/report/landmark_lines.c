#include "sim/lab/report/landmark_lines.h"

#include <errno.h>
#include <string.h>

#include "drivers/base/path.h"

int sim_report_file(const char *directory, const char *name, sim_report_writer *writer,
                    const void *context, struct iso_fault *fault)
{
    char path[PATH_MAX];
    int error = iso_path_join(directory, name, path, fault);
    if (error) {
        return error;
    }
    FILE *out = fopen(path, "we");
    if (!out) {
        return iso_fault_set(fault, -errno, "%s: %s", path, strerror(errno));
    }
    writer(context, out);
    int failed = ferror(out);
    if (fclose(out) != 0 || failed) {
        return iso_fault_set(fault, -EIO, "%s: cannot be written", path);
    }
    return 0;
}

void sim_report_landmarks_header(FILE *out)
{
    fputs("recording,frame,name,x_mm,y_mm,z_mm\n", out);
}

void sim_report_landmarks(const char *recording, size_t frame,
                          const struct iso_vec3 landmark_mm[ISO_LANDMARKS], FILE *out)
{
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        struct iso_vec3 p = landmark_mm[l];
        fprintf(out, "%s,%zu,%s,%.3f,%.3f,%.3f\n", recording, frame,
                iso_landmark_name((enum iso_landmark)l), p.x, p.y, p.z);
    }
}
