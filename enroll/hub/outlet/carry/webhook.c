#include "enroll/hub/outlet/carry/webhook.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/hub/outlet/carry/webhook_text.h"

/* Nobody reads what the receiver says. */
static size_t ignore(char *bytes, size_t size, size_t n, void *context)
{
    (void)bytes;
    (void)context;
    return size * n;
}

static bool add_header(struct curl_slist **list, const char *name, const char *value)
{
    char line[256];
    (void)snprintf(line, sizeof line, "%s:%s%s", name, *value ? " " : "", value);
    struct curl_slist *longer = curl_slist_append(*list, line);
    *list = longer ? longer : *list;
    return longer;
}

static bool make_headers(const struct hub__outlet_row *row, int64_t now_s,
                         const struct hub__batch *batch, const char *body, struct curl_slist **out)
{
    char key[ISO_FLEET_ID_TEXT_SIZE], signature[HUB__SIGNATURE_SIZE];
    hub__webhook_sign(row->secret, now_s, body, signature);
    return add_header(out, "Content-Type", "application/json") &&
           add_header(out, "User-Agent", "isotherm-hub") &&
           add_header(out, "Isotherm-Signature", signature) &&
           add_header(out, "Idempotency-Key", iso_fleet_id_text(&batch->key, key)) &&
           /* Without this header libcurl would ask first whether it may send the body. */
           add_header(out, "Expect", "");
}

static struct hub__delivery judge(CURL *easy)
{
    struct hub__delivery delivery = {.outcome = HUB__TAKEN};
    long status = 0;
    curl_off_t asked_s = 0;
    (void)curl_easy_getinfo(easy, CURLINFO_RESPONSE_CODE, &status);
    (void)curl_easy_getinfo(easy, CURLINFO_RETRY_AFTER, &asked_s);
    if (status >= 200 && status < 300) {
        return delivery;
    }
    if (status == 408 || status == 425 || status == 429 || status >= 500 || status < 200) {
        delivery = hub__delivery_failed(HUB__LATER, "the receiver answers %ld", status);
        delivery.asked_s = asked_s > 0 ? asked_s : 0;
        return delivery;
    }
    return hub__delivery_failed(HUB__REFUSED, "the receiver answers %ld%s", status,
                                status < 400 ? ", a redirection, which is not followed" : "");
}

struct hub__delivery hub__webhook_hand(struct hub__transfer *transfer,
                                       const struct hub__outlet_row *row, int64_t now_s,
                                       const struct hub__batch *batch)
{
    struct curl_slist *headers = NULL;
    struct hub__delivery delivery = hub__delivery_failed(HUB__LATER, "no memory");
    char *body = hub__webhook_body(batch);
    if (body && make_headers(row, now_s, batch, body, &headers)) {
        CURL *easy = transfer->easy;
        hub__transfer_prepare(transfer, row->outlet.address);
        (void)curl_easy_setopt(easy, CURLOPT_HTTPHEADER, headers);
        (void)curl_easy_setopt(easy, CURLOPT_POSTFIELDSIZE_LARGE, (curl_off_t)strlen(body));
        (void)curl_easy_setopt(easy, CURLOPT_POSTFIELDS, body);
        (void)curl_easy_setopt(easy, CURLOPT_TIMEOUT_MS, (long)HUB__ANSWER_MS);
        (void)curl_easy_setopt(easy, CURLOPT_WRITEFUNCTION, ignore);
        delivery = hub__transfer_run(transfer);
        if (delivery.outcome == HUB__TAKEN) {
            delivery = judge(easy);
        }
    }
    curl_slist_free_all(headers);
    free(body);
    return delivery;
}
