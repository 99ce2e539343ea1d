#include "sim/lab/match/landmark_choice.h"

#include <errno.h>
#include <string.h>

#include "drivers/file/text.h"

const bool sim_landmarks_below[ISO_LANDMARKS] = {
    [ISO_LM_SUBNASALE] = true,
    [ISO_LM_LIP_UPPER] = true,
    [ISO_LM_MOUTH_R] = true,
    [ISO_LM_MOUTH_L] = true,
};

/* The landmark with this name, or ISO_LANDMARKS. */
static int find(const char *name)
{
    int l = 0;
    while (l < ISO_LANDMARKS && strcmp(name, iso_landmark_name((enum iso_landmark)l)) != 0) {
        l++;
    }
    return l;
}

int sim_option_landmarks(const char *text, void *field)
{
    bool left_out[ISO_LANDMARKS] = {false};
    char copy[256], *words[ISO_LANDMARKS];
    if (strcmp(text, "all") == 0) {
        memcpy(field, left_out, sizeof left_out);
        return 0;
    }
    if (strcmp(text, "upper") == 0) {
        memcpy(field, sim_landmarks_below, sizeof sim_landmarks_below);
        return 0;
    }
    if ((size_t)snprintf(copy, sizeof copy, "%s", text) >= sizeof copy) {
        return -EINVAL;
    }
    const size_t n = iso_text_split(copy, ',', words, ISO_LANDMARKS);
    if (n > ISO_LANDMARKS) {
        return -EINVAL;
    }
    memset(left_out, true, sizeof left_out);
    for (size_t i = 0; i < n; i++) {
        const int l = find(words[i]);
        if (l == ISO_LANDMARKS || !left_out[l]) {
            return -EINVAL;
        }
        left_out[l] = false;
    }
    memcpy(field, left_out, sizeof left_out);
    return 0;
}
