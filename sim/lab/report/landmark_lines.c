#include "sim/lab/report/landmark_lines.h"

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
