/* Decrypts the file system of /var without the kernel's dm-crypt, which not every host of the test
 * has.
 *
 *   plain_var DISK START SIZE UNIT KEY OUT     START, SIZE: sectors of the disk, behind the header
 * of LUKS; KEY: a file with the 64 bytes of the volume's key (cryptsetup luksDump
 * --dump-volume-key)
 *
 * The cipher is aes-xts-plain64 with sectors of UNIT bytes, whose number in units of 512 bytes is
 * the initial vector (cryptsetup(8)). A block with zeros only was never written, and becomes a
 * hole. */
#include "tests/image/cuts/write_log.h"

#include <endian.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <openssl/evp.h>

enum { BLOCK = 4096, KEY = 64 };

/* Bytes that are encrypted as one: 512 to 4096, as the machine's disk had it. */
static int unit;

static bool is_zero(const unsigned char *block)
{
    return block[0] == 0 && memcmp(block, block + 1, BLOCK - 1) == 0;
}

static void decrypt(EVP_CIPHER_CTX *context, const unsigned char *key, uint64_t n,
                    const unsigned char *in, unsigned char *out)
{
    for (int at = 0; at < BLOCK; at += unit) {
        unsigned char vector[16] = {0};
        uint64_t number = htole64((n * BLOCK + (uint64_t)at) / SECTOR);
        int length = 0;
        memcpy(vector, &number, sizeof(number));
        if (EVP_DecryptInit_ex(context, EVP_aes_256_xts(), NULL, key, vector) != 1 ||
            EVP_DecryptUpdate(context, out + at, &length, in + at, unit) != 1 || length != unit) {
            give_up("block %" PRIu64 " cannot be decrypted", n);
        }
    }
}

static void copy(int disk, uint64_t start, uint64_t blocks, const unsigned char *key, int out)
{
    unsigned char in[BLOCK], plain[BLOCK];
    EVP_CIPHER_CTX *context = EVP_CIPHER_CTX_new();
    if (context == NULL || ftruncate(out, (off_t)(blocks * BLOCK)) != 0) {
        give_up("the file system cannot be written");
    }
    for (uint64_t i = 0; i < blocks; i++) {
        if (pread(disk, in, BLOCK, (off_t)(start * SECTOR + i * BLOCK)) != BLOCK) {
            give_up("the disk cannot be read");
        }
        if (is_zero(in)) {
            continue;
        }
        decrypt(context, key, i, in, plain);
        if (pwrite(out, plain, BLOCK, (off_t)(i * BLOCK)) != BLOCK) {
            give_up("the file system cannot be written");
        }
    }
    EVP_CIPHER_CTX_free(context);
}

int main(int count, char **words)
{
    unsigned char key[KEY];
    if (count != 7) {
        give_up("plain_var DISK START SIZE UNIT KEY OUT");
    }
    unit = atoi(words[4]);
    if (unit < SECTOR || unit > BLOCK || BLOCK % unit != 0) {
        give_up("%s is no size of a sector", words[4]);
    }
    int disk = open(words[1], O_RDONLY | O_CLOEXEC), keys = open(words[5], O_RDONLY | O_CLOEXEC);
    int out = open(words[6], O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (disk < 0 || keys < 0 || out < 0 || read(keys, key, KEY) != KEY) {
        give_up("a file of plain_var cannot be opened, or the key has not %d bytes", KEY);
    }
    copy(disk, strtoull(words[2], NULL, 10), strtoull(words[3], NULL, 10) * SECTOR / BLOCK, key,
         out);
    close(disk);
    close(keys);
    close(out);
    return 0;
}
