/* The reranking of a search by index (core/match/rerank.h): the upper faces of the best few people
 * are opened from the gallery and compared with the probe's.
 *
 * A person before the camera is compared with nearly the same few people in every frame. So the
 * upper faces that were opened last are kept until the gallery changes, and most frames need no
 * access to the database. Biometric data: wiped when a slot is reused and when it is freed. Used by
 * one thread. */
#ifndef ISO_FIRMWARE_RECOGNISE_METHOD_RERANKER_H
#define ISO_FIRMWARE_RECOGNISE_METHOD_RERANKER_H

#include "core/match/rerank.h"
#include "firmware/gallery/candidate_list.h"

struct iso_reranker;

/* -ENOMEM. */
int iso_reranker_new(struct iso_reranker **out) __attribute__((warn_unused_result));

/* Wipes and frees it. NULL is accepted. */
void iso_reranker_free(struct iso_reranker *look);

/* The working memory of reranking, for a search that does not open templates from a gallery. */
struct iso_rerank_workspace *iso_reranker_workspace(struct iso_reranker *look);

/* Wipes the upper faces that are kept, because a person was removed. NULL is fine. */
void iso_reranker_forget(struct iso_reranker *look);

/* Replaces the scores of n (0..ISO_RERANK_CANDIDATES) hits of a search among these candidates by
 * their fused scores, and sorts the hits by falling score. Before the call, the caller sorts the
 * hits by the metric's score, highest first, because more templates are registered for the first
 * ISO_RERANK_FIRST hits (rerank.h). The candidates must be able to open templates. Returns -EINVAL
 * for more hits, or the error of a template that cannot be opened; after an error the hits must not
 * be used. */
int iso_reranker_take(struct iso_reranker *look, const struct iso_metric *metric,
                      const struct iso_candidate_list *among, const struct iso_template *probe,
                      struct iso_search_hit *hits, int n) __attribute__((warn_unused_result));

#endif
