#include "enroll/hub/outlet/carry/transfer.h"

#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

enum { POLL_MS = 1000 };

static void start_curl(void)
{
    (void)curl_global_init(CURL_GLOBAL_DEFAULT);
}

/* libcurl with GnuTLS reads certificates from a file alone, so they are in a file in memory. */
static int put_ca(struct hub__transfer *transfer, const char *ca)
{
    const size_t size = strlen(ca);
    transfer->ca_fd = memfd_create("isotherm-ca", MFD_CLOEXEC);
    if (transfer->ca_fd < 0 || write(transfer->ca_fd, ca, size) != (ssize_t)size) {
        return -ENOMEM;
    }
    (void)snprintf(transfer->ca_path, sizeof transfer->ca_path, "/proc/self/fd/%d",
                   transfer->ca_fd);
    return 0;
}

int hub__transfer_begin(struct hub__transfer *transfer, const char *ca, int stop_fd,
                        struct iso_fault *fault)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    (void)pthread_once(&once, start_curl);
    *transfer = (struct hub__transfer){.stop_fd = stop_fd, .ca_fd = -1};
    transfer->multi = curl_multi_init();
    transfer->easy = curl_easy_init();
    if (!transfer->multi || !transfer->easy || (ca && put_ca(transfer, ca))) {
        hub__transfer_end(transfer);
        return iso_fault_set(fault, -ENOMEM, "an outlet: no memory");
    }
    return 0;
}

void hub__transfer_end(struct hub__transfer *transfer)
{
    if (transfer->multi && transfer->easy) {
        (void)curl_multi_remove_handle(transfer->multi, transfer->easy);
    }
    curl_easy_cleanup(transfer->easy);
    (void)curl_multi_cleanup(transfer->multi);
    if (transfer->ca_fd >= 0) {
        (void)close(transfer->ca_fd);
    }
    *transfer = (struct hub__transfer){.stop_fd = -1, .ca_fd = -1};
}

void hub__transfer_prepare(struct hub__transfer *transfer, const char *url)
{
    CURL *easy = transfer->easy;
    /* A handle that has left its multi handle loses a connection that CURLOPT_CONNECT_ONLY has
     * made, so it leaves only now. */
    (void)curl_multi_remove_handle(transfer->multi, easy);
    curl_easy_reset(easy);
    (void)curl_easy_setopt(easy, CURLOPT_URL, url);
    (void)curl_easy_setopt(easy, CURLOPT_PROTOCOLS_STR, "https,http");
    (void)curl_easy_setopt(easy, CURLOPT_FOLLOWLOCATION, 0L);
    (void)curl_easy_setopt(easy, CURLOPT_SSLVERSION, (long)CURL_SSLVERSION_TLSv1_2);
    (void)curl_easy_setopt(easy, CURLOPT_NOSIGNAL, 1L);
    (void)curl_easy_setopt(easy, CURLOPT_TCP_KEEPALIVE, 1L);
    (void)curl_easy_setopt(easy, CURLOPT_CONNECTTIMEOUT_MS, (long)HUB__CONNECT_MS);
    (void)curl_easy_setopt(easy, CURLOPT_ERRORBUFFER, transfer->error);
    (void)curl_easy_setopt(easy, CURLOPT_NOPROXY, "localhost,127.0.0.1,::1");
    if (*transfer->ca_path) {
        (void)curl_easy_setopt(easy, CURLOPT_CAINFO, transfer->ca_path);
        (void)curl_easy_setopt(easy, CURLOPT_CAPATH, NULL);
    }
}

static struct hub__delivery result_of(struct hub__transfer *transfer)
{
    struct hub__delivery taken = {.outcome = HUB__TAKEN};
    const CURLMsg *message;
    int left = 0;
    while ((message = curl_multi_info_read(transfer->multi, &left))) {
        if (message->msg == CURLMSG_DONE && message->data.result != CURLE_OK) {
            return hub__delivery_failed(
                HUB__LATER, "%s",
                *transfer->error ? transfer->error : curl_easy_strerror(message->data.result));
        }
    }
    return taken;
}

struct hub__delivery hub__transfer_run(struct hub__transfer *transfer)
{
    struct curl_waitfd stop = {.fd = transfer->stop_fd, .events = CURL_WAIT_POLLIN};
    const unsigned n_stop = transfer->stop_fd >= 0 ? 1 : 0;
    struct hub__delivery delivery;
    int running = 1;
    transfer->error[0] = '\0';
    CURLMcode code = curl_multi_add_handle(transfer->multi, transfer->easy);
    while (!code && running && !stop.revents) {
        code = curl_multi_perform(transfer->multi, &running);
        if (!code && running) {
            code = curl_multi_poll(transfer->multi, &stop, n_stop, POLL_MS, NULL);
        }
    }
    if (code) {
        delivery = hub__delivery_failed(HUB__LATER, "%s", curl_multi_strerror(code));
    } else if (running) {
        delivery = hub__delivery_failed(HUB__ENDED, "it was given up");
    } else {
        delivery = result_of(transfer);
    }
    return delivery;
}
