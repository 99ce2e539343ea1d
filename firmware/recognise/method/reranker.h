/* The reranking of a search by index (core/match/rerank.h): the upper faces of the best few
 * people, opened from the gallery and laid on the probe's.
 *
 * Whoever stands before the camera is compared with much the same few people frame after frame, so
 * the upper faces opened last are kept, until the gallery changes: most frames ask the database for
 * nothing. Biometric: wiped when they give way and when it is freed. Used by one thread. */
#ifndef ISO_FIRMWARE_RECOGNISE_METHOD_RERANKER_H
#define ISO_FIRMWARE_RECOGNISE_METHOD_RERANKER_H

#include "core/match/rerank.h"
#include "firmware/gallery/candidate_list.h"

struct iso_reranker;

/* -ENOMEM. */
int iso_reranker_new(struct iso_reranker **out) __attribute__((warn_unused_result));
void iso_reranker_free(struct iso_reranker *look);

/* The working memory of reranking, for a search that needs no look at a gallery. */
struct iso_rerank_workspace *iso_reranker_workspace(struct iso_reranker *look);

/* Wipes the upper faces that are kept: somebody was removed, whose they may be. NULL is fine. */
void iso_reranker_forget(struct iso_reranker *look);

/* Gives n (0..ISO_RERANK_CANDIDATES) hits of a search among these candidates, which can open
 * templates, their fused scores, and sorts them by those, falling. -EINVAL for more hits, else what
 * opening says; then the hits are not to be used. */
int iso_reranker_take(struct iso_reranker *look, const struct iso_metric *metric,
                      const struct iso_candidate_list *among, const struct iso_template *probe,
                      struct iso_search_hit *hits, int n) __attribute__((warn_unused_result));

#endif
