/* The second look of a search by index (core/match/rerank.h): the upper faces of the best few
 * people, opened from the gallery and laid on the probe's.
 *
 * Whoever stands before the camera is compared with much the same few people frame after frame, so
 * the upper faces opened last are kept, until the gallery changes: most frames ask the database for
 * nothing. Biometric: wiped when they give way and when it is freed. Used by one thread. */
#ifndef ISO_FIRMWARE_RECOGNISE_SECOND_LOOK_H
#define ISO_FIRMWARE_RECOGNISE_SECOND_LOOK_H

#include "core/match/rerank.h"
#include "firmware/gallery/candidates.h"

struct iso_second_look;

/* -ENOMEM. */
int iso_second_look_new(struct iso_second_look **out) __attribute__((warn_unused_result));
void iso_second_look_free(struct iso_second_look *look);

/* The working memory of the second look, for a search that needs no look at a gallery. */
struct iso_rerank_workspace *iso_second_look_workspace(struct iso_second_look *look);

/* Wipes the upper faces that are kept: somebody was removed, whose they may be. NULL is fine. */
void iso_second_look_forget(struct iso_second_look *look);

/* Gives n (0..ISO_RERANK_CANDIDATES) hits of a search among these candidates, which can open
 * templates, their fused scores, and sorts them by those, falling. -EINVAL for more hits, else what
 * opening says; then the hits are not to be used. */
int iso_second_look_take(struct iso_second_look *look, const struct iso_metric *metric,
                         const struct iso_candidates *among, const struct iso_template *probe,
                         struct iso_search_hit *hits, int n) __attribute__((warn_unused_result));

#endif
