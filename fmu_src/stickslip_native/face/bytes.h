/* States as bytes: the same on all platforms, for both FMI versions.
 *
 *     offset  size
 *          0     8  "slipstat"
 *          8     4  version of this format
 *         12     4  length of all, in bytes
 *         16     8  FNV-1a of the names of the settable variables, which tell the friction law
 *         24        the fields in the order of `visit` in bytes.c
 *       last     8  FNV-1a of all bytes before
 *
 * Integers and doubles (IEEE 754) are little-endian, a truth value is one byte, 0 or 1. */
#ifndef STICKSLIP_BYTES_H
#define STICKSLIP_BYTES_H

#include "situation.h"
#include "text.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Fowler, Noll, Vo: the hash FNV-1a of 64 bits. The change of one byte always changes it. */
uint64_t hash_of(const void *bytes, size_t count);

/* Count of bytes of every state. */
size_t bytes_count(void);

/* Write bytes_count() bytes. */
void bytes_write(const struct situation *situation, unsigned char *bytes);

/* Read what bytes_write wrote; false with the reason for anything else, whoever made it. */
bool bytes_read(const unsigned char *bytes, size_t size, struct situation *made,
                char reason[MESSAGE_SIZE]);

#endif
