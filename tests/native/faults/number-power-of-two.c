/* Of the decimals beside a power of two only the nearest one is tried.
 * replaces: next_larger
 * detected by: texts
 */
struct decimal {
    char digits[18];
    int count, exponent;
};

struct decimal next_larger(struct decimal it);

struct decimal next_larger(struct decimal it)
{
    return it;
}
