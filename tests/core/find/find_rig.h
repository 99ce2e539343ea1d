/* The search for a face with the shipped head model, and a frame to search in. */
#ifndef TESTS_CORE_FIND_FIND_RIG_H
#define TESTS_CORE_FIND_FIND_RIG_H

#include <stdbool.h>

#include "core/find/pose_search.h"

struct find_rig {
    struct iso_head_model *model;
    struct iso_frame *frame; /* empty at first (rendered_head_frame) */
    struct iso_frame coarse;
    struct iso_candidate_finder *finder;
    struct iso_nose_candidate candidates[ISO_CANDIDATES_MAX];
    int n_candidates, n_parts;
    bool several;
    struct iso_pose_search search;
    struct iso_pose_vertices *vertices;
};

/* The depths in which the rig looks for candidates. */
extern const struct iso_candidate_options find_rig_range;

/* The set-up and the tear-down of a cmocka test whose state is the rig. */
int find_rig_new(void **state);
int find_rig_free(void **state);

/* Shrinks the frame by a factor, and looks for candidates, then for a face. Returns what
 * iso_pose_search() returns; another error fails the test. */
int find_rig_find(struct find_rig *rig, int factor, struct iso_pose_fit *fit);

#endif
