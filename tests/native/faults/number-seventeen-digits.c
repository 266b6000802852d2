/* Numbers in messages have 17 digits where fewer read back.
 * replaces: shortest
 * detected by: texts
 */
struct decimal {
    char digits[18];
    int count, exponent;
};

struct decimal rounded(double value, int count);
struct decimal true_shortest(double value);
struct decimal shortest(double value);

struct decimal shortest(double value)
{
    struct decimal found = true_shortest(value);
    for (; found.count < 17; found.count++) found.digits[found.count] = '0';
    found.digits[found.count] = '\0';
    return found;
}
