//! Whole millimetres typed digit by digit.

/// Number after one more digit; `None`: the digit does not fit, and the number stays.
///
/// The rule of two digits: a second digit makes a number from 10 to `most`, any other second digit is refused. So `1`
/// and `2` are 12, `2` and `0` are 20, but `2` and `5` stay 2 with a `most` of 20. A third digit is always refused.
pub fn typed(before: Option<u8>, digit: u8, most: u8) -> Option<u8> {
    let digit = Some(digit).filter(|digit| *digit <= 9)?;
    let number = match before {
        None => digit,
        Some(0) | Some(10..) => return None,
        Some(tens) => tens * 10 + digit,
    };
    Some(number).filter(|number| *number <= most)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_digit_counts_only_from_ten_to_the_limit() {
        let two = |a, b| typed(typed(None, a, 20), b, 20);
        assert_eq!(
            [two(1, 2), two(2, 0), two(1, 0)],
            [Some(12), Some(20), Some(10)]
        );
        assert_eq!([two(2, 1), two(0, 5), two(9, 9)], [None; 3]);
        assert_eq!(typed(Some(12), 0, 255), None);
        assert_eq!(typed(None, 10, 20), None);
        assert_eq!(typed(None, 4, 3), None);
    }

    #[test]
    fn every_number_up_to_the_limit_can_be_typed() {
        for most in 0..=20u8 {
            for number in 0..=most {
                let text = number.to_string();
                let digits = text.bytes().map(|byte| byte - b'0');
                let found = digits.fold(None, |before, digit| typed(before, digit, most));
                assert_eq!(found, Some(number), "of {most}");
            }
        }
    }
}
